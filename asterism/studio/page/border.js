// The design file's [border] table, as the outline tool changes it: another outline, and holes. Every function makes
// what a change is: {border, pins?} of the design, and {outline?, holes?} to draw until the server answers.

import { bounds, difference, ellipse, isInside, nearestEdge, roundPoint, sum } from "./geometry.js";

/** The border with another outline; its margins and holes stay. */
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
export function curvesOf({ design, outline, holes }) {
  const { circle_mm: round, holes: tables = [] } = design.border ?? {};
  const curve = (hole, circle, ring, number) => {
    const { centre = [0, 0], radius } = circle ?? {};
    const axes = circle && (Array.isArray(radius) ? radius : [radius, radius]);
    return { hole, ring, number, axes: axes ?? null, centre: circle ? centre : bounds(ring).centre };
  };
  const curves = round ? [curve(null, round, outline)] : [];
  let number = 0;
  tables.forEach((table, hole) => {
    if (holes[number] && !table.rods && !table.file) curves.push(curve(hole, table.circle_mm, holes[number], number));
    number += table.file ? (table.rings_mm?.length ?? 1) : 1;
  });
  return curves;
}

const holesOf = (sheet) => sheet.design.border.holes ?? [];
const withHoles = (sheet, holes) => ({ ...sheet.design.border, holes });

/** A curve at another place, or with other half axes. */
export function withCurve(sheet, { hole, ring, number, centre: before, axes: had }, { centre, axes }) {
  const step = difference(roundPoint(centre), before);
  const circle_mm = had && circleOf(centre, axes);
  const now = had ? ellipse(circle_mm.centre, axes) : ring.map((point) => sum(point, step));
  if (hole === null) return [{ border: borderOf(sheet.design, { circle_mm }) }, { outline: now }];
  const table = { ...holesOf(sheet)[hole] };
  if (had) table.circle_mm = circle_mm;
  for (const key of ["polygon_mm", "spline_mm"]) table[key] &&= table[key].map((point) => roundPoint(sum(point, step), 4));
  return [
    { border: withHoles(sheet, holesOf(sheet).with(hole, table)) },
    { holes: sheet.holes.with(number, now) },
  ];
}

/** A new round hole, which comes last. */
export function withHole(sheet, centre, axes) {
  const circle_mm = circleOf(centre, axes);
  return [
    { border: withHoles(sheet, [...holesOf(sheet), { circle_mm }]) },
    { holes: [...sheet.holes, ellipse(circle_mm.centre, axes)] },
  ];
}

/** A hole less; supports of its edge go with it, and those of later holes follow their numbers. */
export function withoutHole(sheet, { hole, number }) {
  const numbers = (held) => held.filter((one) => one !== number).map((one) => (one > number ? one - 1 : one));
  const pins = sheet.tables
    .map((table) => (table.holes ? { ...table, holes: numbers(table.holes) } : table))
    .filter((table) => table.holes?.length !== 0);
  return [
    { border: withHoles(sheet, holesOf(sheet).toSpliced(hole, 1)), pins },
    { holes: sheet.holes.toSpliced(number, 1), pins },
  ];
}

/** Whether a change leaves fabric between the outline and the holes, and between these: the server refuses others. */
export function leavesFabric(sheet, { outline = sheet.outline, holes = sheet.holes }) {
  const isApart = (ring, other) => ring.every((point) => nearestEdge(point, other).distance >= sheet.tipMargin);
  const isBeside = (ring, other) => !isInside(ring[0], other) && !isInside(other[0], ring) && isApart(ring, other);
  return holes.every(
    (ring, k) =>
      ring.every((point) => isInside(point, outline)) &&
      isApart(ring, outline) &&
      holes.slice(0, k).every((other) => isBeside(ring, other)),
  );
}
