// What several tools share: the sheet and the keyboard's star, what a press does, snapping.

import { distance, nearest, nearestOnSegment, roundPoint } from "../../geometry.js";
import { label } from "../pen.js";

/**
 * A tool of the plan. It has a `hint`, and takes pointers in printed mm: down, move, up, cancel, hover, leave. What is
 * edited between down and up is one step; cancel calls it off.
 */
export class PlanTool {
  cursor = "crosshair";
  drag = null; // what is dragged
  ghost = null; // what a click would make where the pointer is

  constructor({ plan, store, edits }) {
    Object.assign(this, { plan, store, edits });
  }

  get sheet() {
    return this.store.get("sheet");
  }

  /** The star of the keyboard. */
  get star() {
    return this.sheet?.byKey.get(this.store.get("cursor"));
  }

  up() {
    this.drag = null;
    this.edits.end();
    this.plan.invalidate();
  }

  cancel() {
    this.drag = null;
    this.edits.cancel();
    this.plan.invalidate();
  }

  leave() {
    this.ghost = null;
    this.plan.invalidate();
  }

  /** A label beside a place on the sheet. */
  say(paint, text, at, [dx, dy] = [12, -12], colour = "accent") {
    const [x, y] = this.plan.toScreen(at);
    label(paint, text, [x + dx, y + dy], "left", colour);
  }
}

const SNAP_PX = 9;
const GRID_MM = 1;

/** A place near the pointer that is worth hitting: [x, y] and what it is. Alt switches snapping for the moment. */
export function snapped(event, plan, { points = [], lines = [], alignTo = [] } = {}) {
  const { store } = plan;
  if (store.get("snap") === event.alt) return { at: roundPoint(event.at, 2), kind: null };
  const reach = plan.px(SNAP_PX);
  const onLine = ([a, b]) => {
    const { point, distance: away } = nearestOnSegment(event.at, a, b);
    return { at: roundPoint(point), kind: "edge", away };
  };
  const seen = points.map((one) => ({ ...one, away: distance(event.at, one.at) }));
  const best = nearest(seen, reach) ?? nearest(lines.map(onLine), reach);
  if (best) return best;
  const at = event.at.map((value, axis) => {
    const near = alignTo.map((other) => other[axis]).find((other) => Math.abs(other - value) < reach);
    return near ?? Math.round(value / GRID_MM) * GRID_MM;
  });
  return { at: roundPoint(at), kind: "grid" };
}

/** Keys of stars within a radius of any of the places, with the distance to the nearest. */
export function starsWithin(sheet, places, radius) {
  const found = [];
  for (const star of sheet.stars) {
    const away = Math.min(...places.map((place) => distance(place, star.at)));
    if (away < radius) found.push({ star, away });
  }
  return found;
}
