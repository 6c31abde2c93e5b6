// What several tools share: pointer pictures, snapping, keys of stars.

import { distance, nearestOnSegment, roundPoint } from "../../geometry.js";

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

export function circle(context, plan, centre, radiusMm) {
  const [x, y] = plan.toScreen(centre);
  context.beginPath();
  context.arc(x, y, Math.max(1, radiusMm * plan.scale), 0, 2 * Math.PI);
}

export function polyline(context, plan, points, isClosed = false) {
  context.beginPath();
  points.forEach((point, k) => {
    const [x, y] = plan.toScreen(point);
    if (k) context.lineTo(x, y);
    else context.moveTo(x, y);
  });
  if (isClosed) context.closePath();
}
