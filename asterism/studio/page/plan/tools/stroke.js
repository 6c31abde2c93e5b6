// Strokes of a brush over the plan: dabs along the way, straight lines with Shift, the star of the keyboard, the ring.

import { between, clamp, direction, distance, images } from "../../geometry.js";
import { RADII, brushOn } from "../../sheet.js";
import { circle, disc, polyline } from "../pen.js";
import { PlanTool, starsWithin } from "./common.js";

const DAB_SHARE = 0.2; // distance of two dabs over the radius
const NONE = new Set();
const FALLOFF_STEPS = 8; // discs of the ring, one in the other, that show how a brush grows weaker

/** Share of a brush's radius at which it has a weight: the inverse of `falloff`. */
const reachOf = (weight) => Math.sqrt(1 - Math.sqrt(weight));

/**
 * A tool that paints. It has a radius under its `setting` in the store, `dab(at, event)`, `said()`, and `isEven` while
 * it does all or nothing.
 */
export class StrokeTool extends PlanTool {
  cursor = "none";
  hint = "Drag to paint\u00a0· Shift+click: a line\u00a0· [ ] radius";
  #at = null;
  #last = null; // end of the last stroke, for straight lines
  #isDown = false;
  #way = 0;

  get brush() {
    return brushOn(this.sheet, this.store.get(this.setting));
  }

  /** A pen that is pressed less paints less. */
  strengthOf({ force = 1 }) {
    return this.brush.strength * force;
  }

  down(event) {
    this.#isDown = true;
    this.edits.begin();
    if (event.shift && this.#last) this.#stroke(this.#last, event.at, event, true);
    else this.dab(event.at, event);
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
    this.#isDown = false;
    this.edits.cancel();
  }

  /** Enter paints at the star of the keyboard; with Shift in a straight line from the last place. */
  key(event) {
    const { star } = this;
    if (event.key !== "Enter" || !star) return false;
    this.down({ at: star.at, shift: event.shiftKey, alt: false });
    this.up();
    this.plan.invalidate();
    return true;
  }

  hover(event) {
    this.#at = event.at;
    const star = this.sheet?.starAt(event.at);
    this.store.set({ hover: star?.key ?? null, under: this.#under() });
    this.plan.invalidate();
  }

  /** Stars under a brush that paints on the sheet in space, which has no ring. */
  #under() {
    const { store } = this;
    if (!store.get("paintOnSheet")) return NONE;
    const near = starsWithin(this.sheet, images(this.#at, store.get("symmetry")), this.brush.radius);
    const keys = near.map(({ star }) => star.key);
    const before = store.get("under");
    return keys.length === before.size && keys.every((key) => before.has(key)) ? before : new Set(keys);
  }

  leave() {
    this.#at = null;
    this.store.set({ hover: null, under: NONE });
    this.plan.invalidate();
  }

  wheel(event) {
    if (!event.altKey) return false;
    this.grow(event.deltaY < 0 ? 1 : -1);
    return true;
  }

  /** A larger or smaller radius. */
  grow(step) {
    const { brush } = this;
    const radius = clamp(Math.round(brush.radius * 1.15 ** step * 2) / 2 + 0.5 * Math.sign(step), ...RADII);
    this.store.set({ [this.setting]: { ...brush, radius } });
  }

  #stroke(from, to, event, isWhole = false) {
    const step = Math.max(1, DAB_SHARE * this.brush.radius);
    const length = distance(from, to);
    let along = isWhole ? 0 : step - this.#way;
    while (along <= length) {
      this.dab(length ? between(from, to, along / length) : to, event);
      along += step;
    }
    this.#way = length - (along - step);
  }

  draw(context, plan, colour) {
    if (!this.#at) return;
    const { radius, strength } = this.brush;
    const symmetry = this.store.get("symmetry");
    const isSolid = this.isEven;
    const accent = colour("accent");
    const veil = { fill: accent, alpha: isSolid ? 0.07 : (0.3 * strength + 0.03) / FALLOFF_STEPS };
    images(this.#at, symmetry).forEach((place, k) => {
      for (let step = 0; step < (isSolid ? 1 : FALLOFF_STEPS); step++)
        circle(context, plan, place, radius * reachOf(step / FALLOFF_STEPS), veil);
      circle(context, plan, place, radius, { colour: accent, width: 1.5, alpha: k ? 0.5 : 1 });
    });
    disc(context, plan.toScreen(this.#at), 2, { fill: accent });
    this.say({ context, colour }, this.said(), this.#at, [10, -8]);
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
  for (const degrees of angles) {
    const end = direction(degrees).map((value) => reach * value);
    polyline(context, plan, [end.map((value) => -value), end], { colour: colour("accent"), dash: [6, 6], alpha: 0.35 });
  }
}
