// The plan of a document together with what is being changed right now, before the server has answered.

import { bounds, centroid, clamp, difference, direction, distance, edgesOf } from "./geometry.js";
import { isInside, nearest, nearestOnSegment, rayLength } from "./geometry.js";
import { QUANTITIES } from "./format.js";

const MIN_ARM_MM = 1; // shorter arms are not printed
const TIP_MARGIN_MM = 0.5;
const CUT_MM = 0.01; // by which an arm is shorter than its size says, if an edge cuts it
const BRUSH_SHARE = 0.17; // of the sheet's shorter side
const BRUSH_SPACINGS = 0.65; // no place of a triangular lattice is more than 0.577 of its spacing away from a star

/** Radii of brushes, mm. */
export const RADII = [2, 200];

/** Stretch of the fabric along x and y. */
export function stretchOf({ fabric }) {
  const stretch = fabric?.stretch ?? 1.35;
  return Array.isArray(stretch) ? stretch : [stretch, stretch];
}

/** The section of the design file that holds the sizes of its pattern. */
export const patternOf = (design) => (design.stars || !design.rods ? "stars" : "rods");

/** What sizes can be given to: stars, all rods, and the lines or layers that can have sizes of their own. `name`: of its rods in the plan. */
export function sizeTargets(design) {
  const targets = design.stars || !design.rods ? [{ path: "stars", text: "Stars" }] : [];
  if (!design.rods) return targets;
  const { draw = [], motif = [], import: drawings = [] } = design.rods;
  const lineOf = (list, end) => ({ name }, k) => ({
    path: `rods.${list}.${k}`,
    text: name || `Line ${k + 1}${end}`,
    name: name || `${list}[${k}]`,
  });
  const lines = [
    ...draw.map(lineOf("draw", "")),
    ...motif.map(lineOf("motif", " of the motif")),
    ...drawings.flatMap(({ file, layers = {} }, k) =>
      Object.keys(layers)
        .filter((layer) => layer && !layer.includes(".")) // dots part the keys of a change
        .map((layer) => ({ path: `rods.import.${k}.layers.${layer}`, text: `${layer}, ${file}`, name: layer })),
    ),
  ];
  return [...targets, { path: "rods", text: "Lines without own sizes" }, ...lines];
}

/** Names of rods that do not have the size of all rods, but one of their own. */
export function namesWithOwn(design, key) {
  const strokes = (design.rods?.import ?? []).map(({ width }) => key === "width_mm" && width === "stroke");
  const hasStroke = (path) => strokes.some((has, k) => has && path.startsWith(`rods.import.${k}.`));
  const own = sizeTargets(design).filter(({ path, name }) => name && (sizeAt(design, path, key).isOwn || hasStroke(path)));
  return new Set(own.map(({ name }) => name));
}

/** The path of what gets sizes: the chosen one if the design has it. */
export function sizeTarget(design, chosen) {
  const targets = sizeTargets(design);
  return (targets.find(({ path }) => path === chosen) ?? targets[0]).path;
}

/** The size at a path of the design; a line without its own has that of all rods. `isOwn`: whether it has. */
export function sizeAt(design, path, key) {
  const own = path.split(".").reduce((table, part) => table?.[part], design)?.[key];
  const isOwn = own !== undefined;
  return { value: isOwn ? own : path.startsWith("rods.") ? design.rods[key] : undefined, isOwn };
}

/** The brush with its radius on a sheet: the user's, or that of the sheet. */
export const brushOn = (sheet, brush) => ({ ...brush, radius: brush.radius ?? sheet?.brushRadius ?? RADII[0] });

/** Stars, outline and supports as they are drawn. `local`: {sizes: Map(key -> {length_mm..}), removed: Map(key -> bool),
 * weights, rods, border, outline, holes, pins}. */
export class Sheet {
  constructor(document, local = emptyLocal()) {
    const { plan, limits } = document;
    const design = local.border ? { ...document.design, border: local.border } : document.design;
    this.design = design;
    this.local = local;
    this.outline = local.outline ?? plan.outline_mm;
    this.spacing = plan.spacing_mm;
    this.limits = { ...limits, law: limits.law ?? {} }; // null until the engine has said what the law covers
    this.printer = plan.printer;
    this.tables = local.pins ?? design.pins ?? [];
    this.pins = plan.pins.map((shown, k) => {
      const table = this.tables[k];
      // held pieces of curves come from the server: numbers of edges are not those of pieces
      const follows = local.outline && table && !table.holes && !(table.edges && isCurved(design));
      return follows ? { ...shown, edges: heldEdges(table, this.outline) } : shown;
    });
    const { arms = 3, orientation_deg: turn = 0 } = design.lattice ?? {};
    this.directions = Array.from({ length: arms }, (_, k) => direction(turn - 90 + (360 * k) / arms));
    this.tipMargin = design.border?.tip_margin_mm ?? TIP_MARGIN_MM;
    this.holes = local.holes ?? plan.holes_mm;
    this.fileRings = plan.hole_rings; // numbers of rings of the tables of holes, 1 unless they are files
    this.stars = plan.sites.map((entry, row) => this.#star(entry, row));
    this.rods = local.rods ?? plan.rods;
    this.byKey = new Map(this.stars.map((star) => [star.key, star]));
    this.box = bounds(this.outline);
    this.centre = centroid(this.outline);
  }

  #star({ site, at_mm: at, ...entry }, row) {
    const { local, outline, holes } = this;
    const key = site.join(",");
    const [change, removal] = [local.sizes.get(key), local.removed.get(key)];
    const sizes = Object.values(QUANTITIES).map(({ key: field, column }) => change?.[field] ?? entry.sizes_mm[column]);
    const removed = removal ?? entry.removed;
    const isReset = local.reset.has(key);
    const isReshaped = Boolean(local.outline || local.holes);
    const isChanged = change !== undefined || removal !== undefined || isReshaped;
    const arms = removed ? [] : isChanged ? this.#arms(at, sizes[0]) : entry.arms;
    const isOn = () => isInside(at, outline) && !holes.some((hole) => isInside(at, hole));
    const isShort = ([from, to]) => distance(from, to) < sizes[0] - CUT_MM;
    return {
      row,
      key,
      site,
      at,
      sizes,
      removed,
      isReset,
      arms,
      painted: !isReset && (entry.painted || change !== undefined),
      weight: local.weights.has(key) ? (local.weights.get(key) ?? 1) : entry.weight,
      isPrinted: arms.length > 0,
      isOffSheet: isReshaped && !isOn(),
      isCut: !removed && sizes[0] >= MIN_ARM_MM && (arms.length < this.directions.length || arms.some(isShort)),
    };
  }

  #arms(at, length) {
    if (length < MIN_ARM_MM) return [];
    return this.directions.map((direction) => {
      const ways = [this.outline, ...this.holes].map((ring) => rayLength(at, direction, ring));
      const room = Math.min(...ways) - this.tipMargin;
      const reach = Math.max(0, Math.min(length, room));
      return [at, [at[0] + reach * direction[0], at[1] + reach * direction[1]]];
    });
  }

  /** Whether the pattern is one of rods, without stars. */
  get isOfRods() {
    return !this.stars.length && this.rods.length > 0;
  }

  /** mm, the radius of a brush that the user has not changed: a share of the sheet, with a star within it everywhere. */
  get brushRadius() {
    const least = this.stars.length ? BRUSH_SPACINGS * this.spacing : 0;
    return clamp(Math.round(Math.max(BRUSH_SHARE * Math.min(...this.box.size), least)), ...RADII);
  }

  /** The values of a quantity on the sheet, of stars and drawn rods. */
  values(quantity) {
    const { key, column } = QUANTITIES[quantity];
    return this.printed.map((star) => star.sizes[column]).concat(this.rods.flatMap((rod) => rod[key] ?? []));
  }

  /** Range of a quantity: of the law of stars if asked for and known, else of the design file, as for rods. */
  range(quantity, inLaw) {
    const { key } = QUANTITIES[quantity];
    return (inLaw && !this.isOfRods && this.limits.law[key]) || this.limits.design[key];
  }

  /** Whether a printed star has a size for which the law was not calibrated. */
  isOutsideLaw(star) {
    if (!star.isPrinted) return false;
    return Object.values(QUANTITIES).some(({ key, column }) => {
      const range = this.limits.law[key];
      return range && (star.sizes[column] < range[0] - 1e-9 || star.sizes[column] > range[1] + 1e-9);
    });
  }

  /** Step of printable values of a quantity, {first, step}; null if sizes are not rounded. */
  printable(quantity) {
    const { rounding } = this.design[patternOf(this.design)] ?? {};
    const { first_layer_mm: first, layer_mm: layer, line_mm: line } = rounding ?? {};
    if (quantity === "thickness" && layer) return { first, step: layer };
    return quantity === "width" && line ? { first: line, step: line } : null;
  }

  /** A value within the limits, and printable where the design rounds. */
  allowed(quantity, value, inLaw) {
    const [low, high] = this.range(quantity, inLaw);
    const steps = this.printable(quantity);
    let kept = value;
    if (steps) kept = steps.first + Math.max(0, Math.round((value - steps.first) / steps.step)) * steps.step;
    return Number(Math.min(Math.max(kept, low), high).toFixed(4));
  }

  /** Path of the line or layer whose rod is at a place, or null. */
  rodTargetAt(point, within) {
    const awayFrom = ({ points_mm: points, width_mm: width }) => {
      const ways = points.slice(1).map((end, k) => nearestOnSegment(point, points[k], end).distance);
      return Math.min(...ways) - Math.max(...width) / 2;
    };
    const rod = nearest(this.rods.map((one) => ({ ...one, away: awayFrom(one) })), within);
    const named = sizeTargets(this.design).filter(({ name }) => name === rod?.name);
    return rod && named.length === 1 ? named[0].path : null; // lines of one name are told apart in the list only
  }

  starAt(point, within = this.spacing * 0.6) {
    return nearest(this.stars.map((star) => ({ star, away: distance(point, star.at) })), within)?.star ?? null;
  }

  neighbours(star) {
    return this.stars.filter((other) => other !== star && distance(other.at, star.at) < 1.3 * this.spacing);
  }

  /** Number of the ring of stars around the middle star to which a star belongs. */
  ring(star) {
    const [i, j] = difference(star.site, this.starAt(this.centre, Infinity).site);
    if ((this.design.lattice?.kind ?? "triangular") !== "triangular") return Math.max(Math.abs(i), Math.abs(j));
    return i * j >= 0 ? Math.abs(i + j) : Math.max(Math.abs(i), Math.abs(j));
  }

  get printed() {
    return this.stars.filter((star) => star.isPrinted);
  }
}

/** Whether edges of the outline are curves of many pieces. */
const isCurved = ({ border }) => Boolean(border?.bulge_mm || border?.spline_mm);

/** Edges that a table holds while the outline is dragged. */
function heldEdges(table, outline) {
  const edges = edgesOf(outline);
  return table.where === "border" ? edges : (table.edges ?? []).map((k) => edges[k]).filter(Boolean);
}

export function emptyLocal() {
  const drawn = { rods: null, border: null, outline: null, holes: null, pins: null };
  return { sizes: new Map(), removed: new Map(), reset: new Set(), weights: new Map(), ...drawn };
}
