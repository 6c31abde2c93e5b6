// The design file's [[pins]] tables, as the needle tool changes them. Tables do not change; every function makes new ones.

import { round, roundPoint } from "./geometry.js";
import { stretchOf } from "./sheet.js";

/** Printed points of a table of points or corners, and where they are taken to. */
export function pointsOf(table, shown) {
  return table.points_mm ?? shown?.points_mm ?? [];
}

export function targetsOf(table, shown) {
  const { target_mm: targets } = table;
  if (targets) return Array.isArray(targets[0]) ? targets : [targets];
  if (!table.points_mm && shown?.places_mm) return shown.places_mm;
  const scale = table.scale ?? 1;
  const [x, y, z] = table.offset_mm ?? [0, 0, 0];
  return pointsOf(table, shown).map((point) => [scale * point[0] + x, scale * point[1] + y, z]);
}

/** All needles of a sheet: {table, point, at, target}, numbers and places. */
export const needlesOf = ({ tables, pins }) =>
  tables.flatMap((table, number) => {
    const targets = targetsOf(table, pins[number]);
    return pointsOf(table, pins[number]).map((at, point) => ({ table: number, point, at, target: targets[point] }));
  });

/** Whether every point of a table can be moved alone. */
export const isPoints = (table) => Array.isArray(table.points_mm);

/** The table with a place of its own for each point, in place of scale and offset. */
function withTargets(table, shown) {
  const { scale, offset_mm, ...rest } = table;
  return { ...rest, target_mm: targetsOf(table, shown).map((target) => [...target]) };
}

function changed(tables, number, table) {
  return tables.map((other, k) => (k === number ? table : other));
}

/** A new needle; it joins the first table of points that holds in the same way. */
export function withNeedle(tables, pins, at, target) {
  const number = tables.findIndex((table) => isPoints(table) && !table.slide && !table.step);
  if (number < 0) {
    const table = { points_mm: [roundPoint(at)], target_mm: [roundPoint(target)] };
    return { tables: [...tables, table], support: { table: tables.length, point: 0 } };
  }
  const table = withTargets(tables[number], pins[number]);
  table.points_mm = [...table.points_mm, roundPoint(at)];
  table.target_mm = [...table.target_mm, roundPoint(target)];
  return { tables: changed(tables, number, table), support: { table: number, point: table.points_mm.length - 1 } };
}

/** Some needles once more, a step (mm) further on the print; `scale`: of the step on the board. */
export function withCopies(tables, pins, members, [dx, dy], scale) {
  return members.reduce(
    (now, { table: number, point }) => {
      const [[x, y], target] = [tables[number].points_mm[point], targetsOf(tables[number], pins[number])[point]];
      const moved = [target[0] + scale * dx, target[1] + scale * dy, target[2]];
      const { tables: more, support } = withNeedle(now.tables, pins, [x + dx, y + dy], moved);
      return { tables: more, copies: [...now.copies, support] };
    },
    { tables, copies: [] },
  );
}

/** A needle's printed place and target changed; either may be left out. */
export function withMoved(tables, pins, { table: number, point }, { at, target }) {
  const table = withTargets(tables[number], pins[number]);
  if (at) table.points_mm = table.points_mm.map((old, k) => (k === point ? roundPoint(at) : old));
  if (target) table.target_mm = table.target_mm.map((old, k) => (k === point ? roundPoint(target) : old));
  return changed(tables, number, table);
}

/** The chosen needles and groups; `support` is the first of them. */
export const membersOf = (support) => (support ? [support, ...(support.also ?? [])] : []);

const isSame = (one, other) => one.table === other.table && one.point === other.point;
export const isChosen = (support, one) => membersOf(support).some((other) => isSame(one, other));

/** The chosen ones with one more, or without it if it is among them. */
export function withChosen(support, one) {
  const chosen = membersOf(support);
  const [first, ...also] = isChosen(support, one) ? chosen.filter((other) => !isSame(one, other)) : [...chosen, one];
  return first ? { ...first, also } : null;
}

/** Several needles, or whole groups (point null), moved on the board by the same step (mm). */
export function withShifted(tables, pins, members, [dx, dy, dz]) {
  const shifted = ([x, y, z]) => [x + dx, y + dy, z + dz];
  return members.reduce((now, { table: number, point }) => {
    const table = now[number];
    if (point !== null) {
      const target = shifted(targetsOf(table, pins[number])[point]);
      return withMoved(now, pins, { table: number, point }, { target });
    }
    if (table.target_mm) return changed(now, number, { ...table, target_mm: targetsOf(table, pins[number]).map(shifted).map((one) => roundPoint(one)) });
    return withTable(now, number, { offset_mm: roundPoint(shifted(table.offset_mm ?? [0, 0, 0])) });
  }, tables);
}

/** A group of corners as needles, each of which can be moved alone; they stay where they are. */
export function split(tables, pins, number) {
  const { where, corners, scale, offset_mm, ...rest } = tables[number];
  const [points_mm, target_mm] = [pins[number].points_mm, targetsOf(tables[number], pins[number])];
  return changed(tables, number, { ...rest, points_mm, target_mm: target_mm.map((target) => roundPoint(target)) });
}

/** Whether a group can be split into needles. */
export const canSplit = (table, shown) => !isPoints(table) && shown?.points_mm.length > 1 && !shown.edges.length;

/** All places on the board drawn together, or apart, about the origin of the sheet; heights stay. */
export const withRatio = (tables, ratio) =>
  tables.map((table) => {
    const drawn = ([x, y, z]) => roundPoint([ratio * x, ratio * y, z]);
    const { target_mm: targets, offset_mm: offset } = table;
    if (targets) return { ...table, target_mm: Array.isArray(targets[0]) ? targets.map(drawn) : drawn(targets) };
    return { ...table, scale: round(ratio * (table.scale ?? 1), 4), ...(offset ? { offset_mm: drawn(offset) } : {}) };
  });

export function withoutNeedle(tables, pins, { table: number, point }) {
  const table = tables[number];
  if (point === null || !isPoints(table) || table.points_mm.length === 1) return tables.filter((_, k) => k !== number);
  const kept = withTargets(table, pins[number]);
  kept.points_mm = kept.points_mm.filter((_, k) => k !== point);
  kept.target_mm = kept.target_mm.filter((_, k) => k !== point);
  return changed(tables, number, kept);
}

/** The tables for an outline that has one corner more, in an edge: what they hold stays where it is. */
export function withCorner(tables, edge) {
  return tables.map((table) => {
    const { where, corners, edges, target_mm: targets } = table;
    if (corners) return { ...table, corners: corners.map((number) => (number > edge ? number + 1 : number)) };
    const k = where ? edge : (edges?.indexOf(edge) ?? -1);
    const now = { ...table };
    if (edges) now.edges = edges.flatMap((one) => (one === edge ? [one, one + 1] : one > edge ? one + 1 : one));
    if (targets && k >= 0) {
      const [from, to] = [targets[k], targets[(k + 1) % targets.length]];
      now.target_mm = targets.toSpliced(k + 1, 0, roundPoint(from.map((value, axis) => (value + to[axis]) / 2)));
    }
    return now;
  });
}

/**
 * The tables for an outline of so many corners without one of them. The edge in place of its two is held if one of them
 * was; with targets, if both were, since it needs a place for each end.
 */
export function withoutCorner(tables, corner, count) {
  const before = (corner + count - 1) % count;
  const less = (numbers) => numbers.map((number) => (number > corner ? number - 1 : number));
  const without = (list, k) => (list && k >= 0 ? list.toSpliced(k, 1) : list);
  const now = tables.map((table) => {
    const { where, corners, edges, target_mm: targets } = table;
    const ends = targets && { target_mm: without(targets, where ? corner : (corners ?? edges ?? []).indexOf(corner)) };
    if (corners) return { ...table, corners: less(corners.filter((number) => number !== corner)), ...ends };
    if (!edges) return { ...table, ...(where ? ends : {}) };
    if (!targets) return { ...table, edges: less([...new Set(edges.map((edge) => (edge === corner ? before : edge)))]) };
    if (edges.includes(corner)) return { ...table, edges: less(edges.filter((edge) => edge !== corner)), ...ends };
    if (!edges.includes(before)) return { ...table, edges: less(edges) };
    return { ...table, edges: less(edges.filter((edge) => edge !== before)), target_mm: targets.slice(0, -1) };
  });
  return now.filter(({ corners, edges }) => (corners ?? edges)?.length !== 0);
}

/** Keys of a whole table changed; undefined removes one. Scale and offset take the place of targets. */
export function withTable(tables, number, patch) {
  const table = { ...tables[number], ...patch };
  if ("scale" in patch || "offset_mm" in patch) delete table.target_mm;
  for (const key of Object.keys(table)) if (table[key] === undefined) delete table[key];
  return changed(tables, number, table);
}

/** Size of the targets over that of the printed points, both about their centres. */
export function spreadOf({ points_mm: points, target_mm: targets }) {
  const size = (all) => {
    const centre = centroidOf(all);
    return Math.hypot(...all.flatMap((point) => [point[0] - centre[0], point[1] - centre[1]]));
  };
  return size(targets) / size(points) || 1;
}

/** Targets drawn together, or apart, about their centre; heights stay. */
export function withSpread(tables, number, spread) {
  const table = tables[number];
  const centre = centroidOf(table.target_mm);
  const factor = spread / spreadOf(table);
  const target_mm = table.target_mm.map(([x, y, z]) =>
    roundPoint([centre[0] + factor * (x - centre[0]), centre[1] + factor * (y - centre[1]), z]),
  );
  return changed(tables, number, { ...table, target_mm });
}

const centroidOf = (points) => [0, 1].map((k) => points.reduce((sum, point) => sum + point[k], 0) / points.length);

/** Scale at which a new needle holds its point: that of the other needles, else what the fabric contracts to. */
export function usualScale(sheet) {
  for (const table of sheet.tables) if (table.scale) return table.scale;
  for (const [k, table] of sheet.tables.entries()) {
    const points = pointsOf(table, sheet.pins[k]);
    const far = points.findIndex(([x, y]) => Math.hypot(x, y) > 5);
    if (far >= 0) {
      const target = targetsOf(table, sheet.pins[k])[far];
      return Math.hypot(target[0], target[1]) / Math.hypot(...points[far]) || 1;
    }
  }
  const [sx, sy] = stretchOf(sheet.design);
  return 1 / Math.sqrt(sx * sy);
}

/** One line that says what a table holds. */
export function titleOf(table, shown) {
  if (table.where === "border") return "Whole outline";
  if (table.where === "corners") return "All corners";
  if (table.edges) return `Edges ${table.edges.join(", ")}`;
  if (table.holes) return `Edges of holes ${table.holes.join(", ")}`;
  if (table.corners) return `Corners ${table.corners.join(", ")}`;
  const count = pointsOf(table, shown).length;
  return count === 1 ? "1 needle" : `${count} needles`;
}
