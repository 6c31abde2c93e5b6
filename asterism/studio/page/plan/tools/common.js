// What several tools share: the sheet and the keyboard's star, snapping, lines and discs of the plan.

import { distance, nearestOnSegment, roundPoint } from "../../geometry.js";

/** A tool of the plan. It has a `hint`, and takes pointers in printed mm: down, move, up, cancel, hover, leave. */
export class PlanTool {
  cursor = "crosshair";

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
}

const SNAP_PX = 9;
const GRID_MM = 1;

/** A place near the pointer that is worth hitting: [x, y] and what it is. Alt switches snapping for the moment. */
export function snapped(event, plan, { points = [], lines = [], alignTo = [] } = {}) {
  const { store } = plan;
  if (store.get("snap") === event.alt) return { at: roundPoint(event.at, 2), kind: null };
  const reach = plan.px(SNAP_PX);
  let best = null;
  for (const { at, kind } of points) {
    const away = distance(event.at, at);
    if (away < reach && (!best || away < best.away)) best = { at, kind, away };
  }
  if (best) return best;
  for (const [a, b] of lines) {
    const { point, distance: away } = nearestOnSegment(event.at, a, b);
    if (away < reach && (!best || away < best.away)) best = { at: roundPoint(point), kind: "edge", away };
  }
  if (best) return best;
  const at = event.at.map((value, axis) => {
    const near = alignTo.map((other) => other[axis]).find((other) => Math.abs(other - value) < reach);
    return near ?? Math.round(value / GRID_MM) * GRID_MM;
  });
  return { at: roundPoint(at), kind: "grid" };
}

export function edgesOf(polygon) {
  return polygon.map((corner, k) => [corner, polygon[(k + 1) % polygon.length]]);
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

/** A disc on the screen, as the path to be filled or drawn. */
export function disc(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

export const circle = (context, plan, centre, radiusMm) =>
  disc(context, plan.toScreen(centre), Math.max(1, radiusMm * plan.scale));

/** Pieces of lines on the screen, [from, to] each, as the path to be drawn. */
export function segments(context, pieces) {
  context.beginPath();
  for (const [from, to] of pieces) {
    context.moveTo(...from);
    context.lineTo(...to);
  }
}

/** Draws along the path with a pen. */
export function stroke(context, { colour, width = 1, dash = [], alpha = 1 }) {
  Object.assign(context, { strokeStyle: colour, lineWidth: width, globalAlpha: alpha });
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

export function polyline(context, plan, points, isClosed = false) {
  context.beginPath();
  points.forEach((point, k) => context[k ? "lineTo" : "moveTo"](...plan.toScreen(point)));
  if (isClosed) context.closePath();
}
