// The design file's [border] table, as the outline tool changes it: another outline, and holes. The functions `with…`
// make what a change is: {border, pins?} of the design, and {outline?, holes?, pins?} to draw until the server answers.

import { bounds, difference, ellipse, isInside, nearestEdge, roundPoint, sum } from "./geometry.js";

/** The border with another outline; its margins stay, and its holes but those of its file. */
export function borderOf(design, shape) {
  const { rings, rectangle_mm, polygon_mm, circle_mm, rods, file, layer, origin, units, ...rest } = design.border ?? {};
  return { ...rest, ...shape };
}

/** A circle of the design file; an ellipse, if its half axes differ. */
export function circleOf(centre, axes) {
  const [a, b] = roundPoint(axes);
  return { centre: roundPoint(centre), radius: a === b ? a : [a, b] };
}

/**
 * Curves with handles: an outline that is a circle or an ellipse (`hole` is null), and the holes that are drawn in the
 * file. `axes`: half axes, null for a hole of another shape; `ring`: the curve on the sheet, `number` that of a hole.
 */
export function curvesOf(sheet) {
  const { outline, holes } = sheet;
  const { circle_mm: round } = sheet.design.border;
  const curve = (hole, circle, ring, number) => {
    const { centre = [0, 0], radius } = circle ?? {};
    const axes = circle && (Array.isArray(radius) ? radius : [radius, radius]);
    return { hole, ring, number, axes: axes ?? null, centre: circle ? centre : bounds(ring).centre };
  };
  const curves = round ? [curve(null, round, outline)] : [];
  holesOf(sheet).forEach((table, hole) => {
    const number = ringOf(sheet, hole);
    if (holes[number] && !table.rods && !table.file) curves.push(curve(hole, table.circle_mm, holes[number], number));
  });
  return curves;
}

/** The tables of holes. */
export const holesOf = (sheet) => sheet.design.border.holes ?? [];

/** The number of the first ring of a table of holes. */
function ringOf(sheet, hole) {
  const rings = (table, k) => (table.file ? (sheet.fileRings[k] ?? 1) : 1);
  return holesOf(sheet)
    .slice(0, hole)
    .reduce((sum, table, k) => sum + rings(table, k), 0);
}

/** The border with other holes, and supports that follow the numbers of rings: `now(number)`, null for one that went. */
function withHoles(sheet, holes, now = null) {
  const { holes: _, ...border } = sheet.design.border;
  const changes = { border: holes.length ? { ...border, holes } : border };
  if (!now || !sheet.tables.some((table) => table.holes)) return changes;
  const follow = (table) => ({ ...table, holes: table.holes.map(now).filter((number) => number !== null) });
  const pins = sheet.tables.map((table) => (table.holes ? follow(table) : table));
  return { ...changes, pins: pins.filter((table) => table.holes?.length !== 0) };
}

/** What to draw of the supports until the server answers. */
const drawn = ({ pins }) => (pins ? { pins } : {});

/** A curve at another place, or with other half axes. */
export function withCurve(sheet, { hole, ring, number, centre: before, axes: had }, { centre, axes }) {
  const step = difference(roundPoint(centre), before);
  const circle_mm = had && circleOf(centre, axes);
  const now = had ? ellipse(circle_mm.centre, axes) : ring.map((point) => sum(point, step));
  if (hole === null) return [{ border: borderOf(sheet.design, { circle_mm }) }, { outline: now }];
  const table = { ...holesOf(sheet)[hole] };
  if (had) table.circle_mm = circle_mm;
  for (const key of ["polygon_mm", "spline_mm"]) table[key] &&= table[key].map((point) => roundPoint(sum(point, step), 4));
  return [withHoles(sheet, holesOf(sheet).with(hole, table)), { holes: sheet.holes.with(number, now) }];
}

/** A new round hole, the last of the tables; those of the outline's file come after it. */
export function withHole(sheet, centre, axes) {
  const circle_mm = circleOf(centre, axes);
  const first = ringOf(sheet, holesOf(sheet).length);
  const changes = withHoles(sheet, [...holesOf(sheet), { circle_mm }], (number) => (number < first ? number : number + 1));
  return [changes, { holes: sheet.holes.toSpliced(first, 0, ellipse(circle_mm.centre, axes)), ...drawn(changes) }];
}

/** A hole less; supports of its edge go with it, and those of later holes follow their numbers. */
export function withoutHole(sheet, { hole, number }) {
  const now = (one) => (one === number ? null : one > number ? one - 1 : one);
  const changes = withHoles(sheet, holesOf(sheet).toSpliced(hole, 1), now);
  return [changes, { holes: sheet.holes.toSpliced(number, 1), ...drawn(changes) }];
}

/** Whether a change leaves fabric between the outline and the holes, and between these: the server refuses others. */
export function leavesFabric(sheet, { outline = sheet.outline, holes = sheet.holes }) {
  const isFar = (ring, other) => ring.every((point) => nearestEdge(point, other).distance >= sheet.tipMargin);
  const isApart = (ring, other) => isFar(ring, other) && isFar(other, ring);
  const isBeside = (ring, other) => !isInside(ring[0], other) && !isInside(other[0], ring) && isApart(ring, other);
  return holes.every(
    (ring, k) =>
      ring.every((point) => isInside(point, outline)) &&
      isApart(ring, outline) &&
      holes.slice(0, k).every((other) => isBeside(ring, other)),
  );
}
