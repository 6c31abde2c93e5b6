// The plan of a document together with what is being changed right now, before the server has answered.

import { bounds, centroid, clamp, distance, isInside, nearestIndex, nearestOnSegment, rayLength } from "./geometry.js";
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
  const lines = [
    ...draw.map(({ name }, k) => ({
      path: `rods.draw.${k}`,
      text: name || `Line ${k + 1}`,
      name: name || `draw[${k}]`,
    })),
    ...motif.map(({ name }, k) => ({
      path: `rods.motif.${k}`,
      text: name || `Line ${k + 1} of the motif`,
      name: name || `motif[${k}]`,
    })),
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

const keyOf = (site) => `${site[0]},${site[1]}`;

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
    this.printer = plan.printer ?? null;
    this.tables = local.pins ?? design.pins ?? [];
    this.pins = (plan.pins ?? []).map((shown, k) => {
      const table = this.tables[k];
      // held pieces of curves come from the server: numbers of edges are not those of pieces
      const follows = local.outline && table && !table.holes && !(table.edges && isCurved(design));
      return follows ? { ...shown, edges: heldEdges(table, this.outline) } : shown;
    });
    this.directions = armDirections(design.lattice ?? {});
    this.tipMargin = design.border?.tip_margin_mm ?? TIP_MARGIN_MM;
    this.holes = local.holes ?? plan.holes_mm ?? [];
    this.fileRings = plan.hole_rings ?? []; // numbers of rings of the tables of holes, 1 unless they are files
    this.stars = plan.sites.map((entry, row) => this.#star(entry, row));
    this.rods = local.rods ?? plan.rods ?? [];
    this.byKey = new Map(this.stars.map((star) => [star.key, star]));
    this.box = bounds(this.outline.concat(this.outline.length ? [] : [[0, 0]]));
    this.centre = centroid(this.outline);
  }

  #star(entry, row) {
    const key = keyOf(entry.site);
    const change = this.local.sizes.get(key);
    const removal = this.local.removed.get(key);
    const sizes = entry.sizes_mm.slice();
    for (const { key: field, column } of Object.values(QUANTITIES)) {
      if (change?.[field] !== undefined) sizes[column] = change[field];
    }
    const weight = this.local.weights.has(key) ? (this.local.weights.get(key) ?? 1) : (entry.weight ?? 1);
    const removed = removal ?? entry.removed;
    const isReshaped = Boolean(this.local.outline || this.local.holes);
    const isChanged = change !== undefined || removal !== undefined || isReshaped;
    const star = {
      row,
      key,
      site: entry.site,
      at: entry.at_mm,
      removed,
      painted: entry.painted || change !== undefined,
      sizes,
      weight,
    };
    star.isReset = this.local.reset.has(key);
    if (star.isReset) star.painted = false;
    if (isChanged) star.arms = removed ? [] : this.#arms(star.at, sizes[0]);
    else star.arms = removed ? [] : (entry.arms ?? this.#arms(star.at, sizes[0]));
    star.isPrinted = star.arms.length > 0;
    star.isOffSheet = isReshaped
      ? !isInside(star.at, this.outline) || this.holes.some((hole) => isInside(star.at, hole))
      : entry.on_sheet === false;
    const reach = star.arms.map(([from, to]) => distance(from, to));
    star.isCut =
      !removed &&
      sizes[0] >= MIN_ARM_MM &&
      (reach.length < this.directions.length || Math.min(...reach) < sizes[0] - CUT_MM);
    return star;
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
    if (!rounding || quantity === "length") return null;
    if (quantity === "width") return rounding.line_mm ? { first: rounding.line_mm, step: rounding.line_mm } : null;
    return rounding.layer_mm ? { first: rounding.first_layer_mm, step: rounding.layer_mm } : null;
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
    const reach = (rod) =>
      rod.points_mm.slice(1).reduce((least, end, k) => {
        const { distance: away } = nearestOnSegment(point, rod.points_mm[k], end);
        return Math.min(least, away - Math.max(...rod.width_mm) / 2);
      }, Infinity);
    const { index, distance: away } = leastOf(this.rods.map(reach));
    if (index < 0 || away > within) return null;
    const named = sizeTargets(this.design).filter(({ name }) => name === this.rods[index].name);
    return named.length === 1 ? named[0].path : null; // lines of one name are told apart in the list only
  }

  starAt(point, within = this.spacing * 0.6) {
    const { index, distance: away } = nearestIndex(
      point,
      this.stars.map((star) => star.at),
    );
    return index >= 0 && away <= within ? this.stars[index] : null;
  }

  neighbours(star) {
    return this.stars.filter((other) => other !== star && distance(other.at, star.at) < 1.3 * this.spacing);
  }

  /** Number of the ring of stars around the middle star to which a star belongs. */
  ring(star) {
    const { index } = nearestIndex(
      this.centre,
      this.stars.map((other) => other.at),
    );
    const [i, j] = [0, 1].map((k) => star.site[k] - this.stars[index].site[k]);
    if ((this.design.lattice?.kind ?? "triangular") !== "triangular") return Math.max(Math.abs(i), Math.abs(j));
    return i * j >= 0 ? Math.abs(i + j) : Math.max(Math.abs(i), Math.abs(j));
  }

  get printed() {
    return this.stars.filter((star) => star.isPrinted);
  }
}

function leastOf(values) {
  const distance = Math.min(Infinity, ...values);
  return { index: values.indexOf(distance), distance };
}

/** Whether edges of the outline are curves of many pieces. */
const isCurved = ({ border }) => Boolean(border?.bulge_mm || border?.spline_mm);

/** Edges that a table holds while the outline is dragged. */
function heldEdges(table, outline) {
  const numbers = table.where === "border" ? outline.map((_, k) => k) : (table.edges ?? []);
  return numbers.filter((k) => outline[k]).map((k) => [outline[k], outline[(k + 1) % outline.length]]);
}

export function emptyLocal() {
  const drawn = { rods: null, border: null, outline: null, holes: null, pins: null };
  return { sizes: new Map(), removed: new Map(), reset: new Set(), weights: new Map(), ...drawn };
}

function armDirections(lattice) {
  const count = lattice.arms ?? 3;
  const turn = ((lattice.orientation_deg ?? 0) * Math.PI) / 180;
  return Array.from({ length: count }, (_, k) => {
    const angle = turn - Math.PI / 2 + (2 * Math.PI * k) / count;
    return [Math.cos(angle), Math.sin(angle)];
  });
}
