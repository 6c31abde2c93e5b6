// Panel of the brush of weights: where a fit comes nearer to the target.

import { button, h, hint, refresh, segments } from "../dom.js";
import { plural } from "../format.js";
import { STRONG } from "../plan/weights.js";
import { RADII, brushOn } from "../sheet.js";
import { symmetry } from "./brush.js";
import { numberField } from "./fields.js";

const MODES = {
  paint: {
    text: "Paint",
    title: "Paint a weight",
    says: "A place of weight 10 counts ten times as much in the fit. Other places come out further away.",
  },
  erase: { text: "Erase", title: "Erase weights", says: "Places without a weight count once." },
};
const WEIGHT = { unit: "×", step: 0.1, digits: 2, min: 0.1, max: STRONG }; // the design file allows more
const RADIUS = { min: RADII[0], max: RADII[1], step: 0.5 };
const STRENGTH = { unit: "%", min: 1, max: 100, step: 1 };

export function weightPanel({ store, actions, edits }, { on }) {
  const brush = () => brushOn(store.get("sheet"), store.get("weightBrush"));
  const change = (patch) => store.set({ weightBrush: { ...store.get("weightBrush"), ...patch } });
  const mode = segments({
    label: "Brush mode",
    testid: "weight-mode",
    options: Object.entries(MODES).map(([value, { text, title }]) => ({ value, text, title })),
    value: brush().mode,
    onchange: (value) => change({ mode: value }),
  });
  const says = hint("");
  const field = (label, key, testid, options, factor = 1) =>
    numberField({
      label,
      testid,
      value: factor * brush()[key],
      slider: true,
      onchange: (value) => change({ [key]: value / factor }),
      ...options,
    });
  const weight = field("Weight", "weight", "weight", WEIGHT);
  const radius = field("Radius", "radius", "weight-radius", RADIUS);
  const strength = field("Strength", "strength", "weight-strength", STRENGTH, 100);
  const below = h("div", {});

  function update() {
    const { mode: way } = brush();
    says.textContent = MODES[way].says;
    mode.set(way);
    weight.set(brush().weight);
    radius.set(brush().radius);
    strength.set(Math.round(100 * brush().strength));
    weight.element.hidden = strength.element.hidden = way === "erase";
    const weighed = store.get("sheet")?.stars.filter((star) => star.weight !== 1).map((star) => star.key) ?? [];
    const { target } = store.get("state");
    refresh(below, [weighed, Boolean(target), Boolean(store.get("document"))], () => [
      hint(weighed.length ? `${plural(weighed.length, "star")} with a weight.` : "All places count alike."),
      button({
        text: "Erase all weights",
        kind: "wide",
        testid: "weight-clear",
        disabled: !weighed.length,
        onclick: () => edits.once(() => edits.weigh(new Map(weighed.map((key) => [key, null])))),
      }),
      target
        ? button({ text: "To the fit", kind: "wide", testid: "weight-fit", onclick: () => actions.showPage("shape") })
        : hint("Weights count in the fit to a target. Load one on the page Shape."),
    ]);
  }
  on(["weightBrush", "sheet", "state", "document"], update);
  update();
  return [mode.element, says, weight.element, radius.element, strength.element, below, ...symmetry({ store }, { on })];
}
