// The brush: paints sizes of stars along a stroke, or smooths, erases, removes and restores.

import { between, clamp, distance, images } from "../../geometry.js";
import { QUANTITIES, fixed } from "../../format.js";
import { circle, polyline, starsWithin } from "./common.js";
import { label } from "../draw.js";

const DAB_SHARE = 0.2; // distance of two dabs over the radius

export class BrushTool {
  cursor = "none";
  #at = null;
  #last = null; // end of the last stroke, for straight lines
  #isDown = false;
  #way = 0;

  constructor({ plan, store, edits }) {
    Object.assign(this, { plan, store, edits });
  }

  get hint() {
    return "Drag to paint · Shift+click: a line · [ ] radius";
  }

  down(event) {
    this.#isDown = true;
    this.edits.begin();
    if (event.shift && this.#last) this.#stroke(this.#last, event.at, event, true);
    else this.#dab(event.at, event);
    this.#at = this.#last = event.at;
    this.#way = 0;
  }

  move(event) {
    if (!this.#isDown) return this.hover(event);
    this.#stroke(this.#last, event.at, event);
    this.#last = event.at;
    this.hover(event);
  }

  up() {
    if (!this.#isDown) return;
    this.#isDown = false;
    this.edits.end();
  }

  cancel() {
    this.up();
  }

  /** Enter paints at the star of the keyboard; with Shift in a straight line from the last place. */
  key(event) {
    const star = this.store.get("sheet").byKey.get(this.store.get("cursor"));
    if (event.key !== "Enter" || !star) return false;
    this.down({ at: star.at, shift: event.shiftKey, alt: false });
    this.up();
    this.plan.invalidate();
    return true;
  }

  hover(event) {
    this.#at = event.at;
    const star = this.store.get("sheet")?.starAt(event.at);
    this.store.set({ hover: star?.key ?? null });
    this.plan.invalidate();
  }

  leave() {
    this.#at = null;
    this.store.set({ hover: null });
    this.plan.invalidate();
  }

  wheel(event) {
    if (!event.altKey) return false;
    this.grow(event.deltaY < 0 ? 1 : -1);
    return true;
  }

  /** A larger or smaller radius. */
  grow(step) {
    const brush = this.store.get("brush");
    const radius = clamp(Math.round(brush.radius * 1.15 ** step * 2) / 2 + 0.5 * Math.sign(step), 2, 200);
    this.store.set({ brush: { ...brush, radius } });
  }

  #stroke(from, to, event, isWhole = false) {
    const step = Math.max(1, DAB_SHARE * this.store.get("brush").radius);
    const length = distance(from, to);
    let along = isWhole ? 0 : step - this.#way;
    while (along <= length) {
      this.#dab(length ? between(from, to, along / length) : to, event);
      along += step;
    }
    this.#way = length - (along - step);
  }

  #dab(at, event) {
    const { store, edits } = this;
    const sheet = store.get("sheet");
    const { quantity, mode, radius, strength, target, amount } = store.get("brush");
    const near = starsWithin(sheet, images(at, store.get("symmetry")), radius);
    if (!near.length) return;
    const keys = (wanted) => near.filter(({ star }) => wanted(star)).map(({ star }) => star.key);
    if (mode === "remove") {
      if (event.alt) return void edits.restore(keys((star) => star.removed));
      const kept = keys((star) => !star.removed);
      if (kept.length < sheet.printed.length) edits.remove(kept);
      return;
    }
    if (mode === "erase") return void edits.reset(keys((star) => star.painted));
    const { column } = QUANTITIES[quantity];
    const values = new Map();
    for (const { star, away } of near) {
      if (star.removed) continue;
      const share = strength * (1 - (away / radius) ** 2) ** 2;
      const old = star.sizes[column];
      let value = old;
      if (mode === "set") value = old + share * (target - old);
      else if (mode === "add") value = old + share * (event.alt ? -amount : amount);
      else if (mode === "smooth") value = old + share * (this.#mean(sheet, star, column) - old);
      const kept = sheet.allowed(quantity, value, store.get("inLaw"));
      if (Math.abs(kept - old) > 1e-4) values.set(star.key, kept);
    }
    if (values.size) edits.sizes(quantity, values);
  }

  #mean(sheet, star, column) {
    const others = sheet.neighbours(star).filter((other) => other.isPrinted);
    if (!others.length) return star.sizes[column];
    return others.reduce((total, other) => total + other.sizes[column], 0) / others.length;
  }

  draw(context, plan, colour) {
    if (!this.#at) return;
    const { radius, mode, target, amount, quantity } = this.store.get("brush");
    const symmetry = this.store.get("symmetry");
    images(this.#at, symmetry).forEach((place, k) => {
      circle(context, plan, place, radius);
      context.fillStyle = colour("accent");
      context.globalAlpha = 0.07;
      context.fill();
      context.globalAlpha = k ? 0.5 : 1;
      context.strokeStyle = colour("accent");
      context.lineWidth = 1.5;
      context.stroke();
      context.globalAlpha = 1;
    });
    const [x, y] = plan.toScreen(this.#at);
    context.fillStyle = colour("accent");
    context.beginPath();
    context.arc(x, y, 2, 0, 2 * Math.PI);
    context.fill();
    const digits = QUANTITIES[quantity].digits;
    const said = {
      set: `${fixed(target, digits)} mm`,
      add: `${amount < 0 ? "−" : "+"}${fixed(Math.abs(amount), digits)} mm`,
      smooth: "smooth",
      erase: "erase",
      remove: "remove",
    }[mode];
    label({ context, colour }, said, [x + 10, y - 8], "left", "accent");
    drawAxes(context, plan, colour, symmetry);
  }
}

/** Dashed lines of the mirrors. */
function drawAxes(context, plan, colour, { mirrorX, mirrorY, sixfold }) {
  const reach = 3000;
  const angles = [];
  if (mirrorX) angles.push(90);
  if (mirrorY) angles.push(0);
  if (sixfold) angles.push(0, 60, 120);
  context.strokeStyle = colour("accent");
  context.globalAlpha = 0.35;
  context.lineWidth = 1;
  context.setLineDash([6, 6]);
  for (const degrees of angles) {
    const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
    polyline(context, plan, [
      [-reach * c, -reach * s],
      [reach * c, reach * s],
    ]);
    context.stroke();
  }
  context.setLineDash([]);
  context.globalAlpha = 1;
}
