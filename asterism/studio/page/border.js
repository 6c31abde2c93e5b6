// The design file's [border] table, as the outline tool changes it: another outline, and holes. The functions `with…`
// make what a change is: {border, pins?} of the design, and {outline?, holes?, pins?} to draw until the server answers.

import {
  arcs,
  bounds,
  clamp,
  crossesItself,
  difference,
  distance,
  edgeOf,
  ellipse,
  isClockwise,
  isInside,
  nearestEdge,
  round,
  roundPoint,
  smooth,
  sum,
} from "./geometry.js";
import { withCorner, withoutCorner } from "./supports.js";

/** The border with another outline; its margins stay, and its holes but those of its file. */
export function borderOf(design, shape) {
  const { rings, rectangle_mm, polygon_mm, bulge_mm, circle_mm, spline_mm, rods, ...others } = design.border ?? {};
  const { file, layer, origin, units, ...rest } = others;
  return { ...rest, ...shape };
}

/** A circle of the design file; an ellipse, if its half axes differ. */
export function circleOf(centre, axes, turn = 0) {
  const [a, b] = roundPoint(axes);
  return { centre: roundPoint(centre), radius: a === b ? a : [a, b], ...(a !== b && turn ? { turn_deg: turn } : {}) };
}

/**
 * Curves with handles: the outline (`hole` is null), then the holes that are drawn in the file. `ring`: the curve on the
 * sheet, `number` that of a hole. `kind`: "circle" with `axes`, half of them, and their `turn` in degrees; "polygon" with
 * `points`, counterclockwise, and the `bulges` of its edges; "spline" with `points`.
 */
export function curvesOf(sheet) {
  const curves = [{ hole: null, ring: sheet.outline, ...shapeOf(sheet.design.border ?? {}, sheet.outline) }];
  holesOf(sheet).forEach((table, hole) => {
    const number = ringOf(sheet, hole);
    const ring = sheet.holes[number];
    if (ring && !table.rods && !table.file) curves.push({ hole, ring, number, ...shapeOf(table, ring) });
  });
  return curves;
}

function shapeOf({ circle_mm: circle, polygon_mm, bulge_mm = [], spline_mm }, ring) {
  if (circle) {
    const { centre = [0, 0], radius, turn_deg: turn = 0 } = circle;
    return { kind: "circle", centre, axes: Array.isArray(radius) ? radius : [radius, radius], turn };
  }
  const given = spline_mm ?? polygon_mm ?? ring;
  let points = given.filter((point, k) => !k || k < given.length - 1 || distance(point, given[0]) > 0);
  let bulges = points.map((_, k) => bulge_mm[k] ?? 0);
  // supports count the corners counterclockwise
  if (isClockwise(points)) [points, bulges] = [points.toReversed(), bulges.map((_, k) => bulges.at(-2 - k) ?? bulges.at(-1))];
  return { kind: spline_mm ? "spline" : "polygon", points, bulges, centre: bounds(ring).centre };
}

/** Points of a curve from each of its given points to before the next. */
function piecesOf({ kind, centre, axes, turn, points, bulges }) {
  if (kind === "circle") return [ellipse(centre, axes, { turn })];
  return kind === "spline" ? smooth(points) : arcs(points, bulges);
}

function tableOf({ kind, centre, axes, turn, points, bulges }) {
  if (kind === "circle") return { circle_mm: circleOf(centre, axes, turn) };
  if (kind === "spline") return { spline_mm: points };
  return bulges.some(Boolean) ? { polygon_mm: points, bulge_mm: bulges } : { polygon_mm: points };
}

/** What makes a curve one of another kind. */
export function ofKind(curve, kind) {
  const { centre, size } = bounds(curve.ring);
  if (kind === "circle") return { kind, centre, axes: size.map((value) => value / 2), turn: 0 };
  const bent = (point, k) => (curve.bulges[k] ? [point, middleOf(curve, k)] : [point]);
  const points = curve.points ? curve.points.flatMap(bent) : ellipse(curve.centre, curve.axes, { count: 8, turn: curve.turn });
  return { kind, points, bulges: points.map(() => 0) };
}

/** The middle of an edge of a polygon, or of the part of a spline from one point to the next. */
export function middleOf(curve, k) {
  if (curve.kind === "spline") {
    const piece = piecesOf(curve)[k];
    return piece.at(piece.length / 2);
  }
  const { middle, out } = edgeOf(curve.points, k);
  return sum(middle, out.map((value) => value * curve.bulges[k]));
}

/** The nearest place of a curve: {point, distance, edge}, with the number of the given point before it. */
export function nearestOn(curve, at) {
  const pieces = piecesOf(curve);
  const { edge, ...found } = nearestEdge(at, pieces.flat());
  let [k, left] = [0, edge];
  while (left >= pieces[k].length) left -= pieces[k++].length;
  return { ...found, edge: k };
}

/**
 * One point more on the curve, after point k. Parts of an arc are arcs of the same circle. `follow`: what becomes of the
 * supports of an outline.
 */
export function morePoints({ points, bulges }, k, point) {
  const bulge = bulges[k];
  const radius = bulge && (edgeOf(points, k).half ** 2 + bulge ** 2) / (2 * bulge);
  const part = (end) => radius && radius - Math.sign(radius) * Math.sqrt(radius ** 2 - distance(point, end) ** 2 / 4);
  const parts = [part(points[k]), part(points[(k + 1) % points.length])];
  const follow = (tables) => withCorner(tables, k);
  return { points: points.toSpliced(k + 1, 0, point), bulges: bulges.toSpliced(k, 1, ...parts), follow };
}

/** One point less; the edge that takes the place of its two is straight. */
export function fewerPoints({ points, bulges }, k) {
  const follow = (tables) => withoutCorner(tables, k, points.length);
  return { points: points.toSpliced(k, 1), bulges: bulges.toSpliced(k, 1).with(k - 1, 0), follow };
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

/** A curve with other values; points follow its centre, and arcs stay within half a circle. */
export function withCurve(sheet, curve, change) {
  const now = { ...curve, ...change };
  if (now.kind !== "circle") {
    const step = difference(roundPoint(now.centre), curve.centre);
    now.points = now.points.map((point) => roundPoint(change.centre ? sum(point, step) : point));
    const within = (half, bulge) => round(clamp(bulge, -half, half));
    now.bulges = now.bulges.map((bulge, k) => within(edgeOf(now.points, k).half, bulge));
  }
  const [ring, shape] = [piecesOf(now).flat(), tableOf(now)];
  if (curve.hole === null) {
    const pins = now.follow && sheet.tables.length ? { pins: now.follow(sheet.tables) } : {};
    return [{ border: borderOf(sheet.design, shape), ...pins }, { outline: ring, ...pins }];
  }
  const { circle_mm, polygon_mm, bulge_mm, spline_mm, ...rest } = holesOf(sheet)[curve.hole];
  const holes = holesOf(sheet).with(curve.hole, { ...rest, ...shape });
  return [withHoles(sheet, holes), { holes: sheet.holes.with(curve.number, ring) }];
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

const MAX_CHECKED = 1500;

/** Why the server would refuse a change: an edge crosses itself, or leaves too little fabric; null if it would not. */
export function refusalOf(sheet, { outline = sheet.outline, holes = sheet.holes }) {
  const changed = [outline, ...holes].filter((ring) => ring !== sheet.outline && !sheet.holes.includes(ring));
  // the server has the last word; a check of many points would hold up the drag
  if (changed.some((ring) => ring.length < MAX_CHECKED && crossesItself(ring))) return "An edge must not cross itself.";
  const isFar = (ring, other) => ring.every((point) => nearestEdge(point, other).distance >= sheet.tipMargin);
  const isApart = (ring, other) => isFar(ring, other) && isFar(other, ring);
  const isBeside = (ring, other) => !isInside(ring[0], other) && !isInside(other[0], ring) && isApart(ring, other);
  const hasRoom = holes.every(
    (ring, k) =>
      ring.every((point) => isInside(point, outline)) &&
      isApart(ring, outline) &&
      holes.slice(0, k).every((other) => isBeside(ring, other)),
  );
  return hasRoom ? null : `No room: a hole needs ${sheet.tipMargin} mm of fabric around it.`;
}
