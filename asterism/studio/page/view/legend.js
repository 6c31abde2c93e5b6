// The legend of the colours: a strip with its numbers.

import { FIELDS, digitsOf, ramp } from "./colours.js";
import { fixed } from "../format.js";
import { h, replace } from "../dom.js";

const HEIGHT_PX = 120;

export function showLegend(element, name, domain) {
  const field = FIELDS[name];
  element.hidden = !field.scale || !domain;
  if (element.hidden) return;
  const strip = h("canvas", { width: 1, height: HEIGHT_PX, "aria-hidden": "true" });
  const context = strip.getContext("2d");
  for (let k = 0; k < HEIGHT_PX; k++) {
    context.fillStyle = ramp(field.scale, 1 - k / (HEIGHT_PX - 1));
    context.fillRect(0, k, 1, 1);
  }
  const step = (domain[1] - domain[0]) / 4;
  const ticks = [4, 3, 2, 1, 0].map((k) => domain[0] + k * step);
  const digits = field.digits ?? digitsOf(step);
  replace(element, [
    h("div.title", `${field.title ?? field.name}, ${field.unit}`),
    h("div.scale", strip, h("div.ticks", ticks.map((value) => h("span", fixed(value, digits))))),
  ]);
}
