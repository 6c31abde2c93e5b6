// The outline and holes: drag corners, click an edge to add one, Delete removes; the middle of an edge bends it. Circles
// and ellipses have handles at their centre, at the ends of their half axes, and one that turns them. A drag over the
// sheet cuts a round hole.

import {
  borderOf,
  circleOf,
  curvesOf,
  fewerPoints,
  holesOf,
  middleOf,
  morePoints,
  nearestOn,
  refusalOf,
  withCurve,
  withHole,
  withoutHole,
} from "../../border.js";
import {
  clamp,
  difference,
  direction,
  distance,
  dot,
  edgeOf,
  ellipse,
  isInside,
  nearest,
  round,
  roundPoint,
  sum,
} from "../../geometry.js";
import { isDelete, signOf } from "../../dom.js";
import { toast } from "../../panels/toasts.js";
import { circle, disc, draw, polyline } from "../pen.js";
import { PlanTool, snapped } from "./common.js";
import { fixed, mm, plural } from "../../format.js";

const GRIP_PX = 12;
const CLICK_PX = 4;
const TURN_PX = 26; // from an ellipse to the handle that turns it
const TURN_STEP_DEG = 5;
const LEAST_EDGE_PX = 56; // shorter edges on the screen have no handle that bends them
const LEAST_RADIUS_MM = 2; // of a hole that is drawn
const MAX_ASPECT = 20; // of the half axes of an ellipse
const HINTS = {
  circle: "Drag handles\u00a0· Shift: one axis",
  polygon: "Drag corners, bend edges at their middle\u00a0· click an edge to add one",
  spline: "Drag points\u00a0· click the curve to add one",
};

/**
 * `drag`: {curve, part, index, start, sheet}, with the sheet before; a new hole has no curve. `ghost`: the place of a new
 * corner.
 */
export class OutlineTool extends PlanTool {
  get hint() {
    return `${this.sheet ? HINTS[this.chosen().kind] : ""}\u00a0· drag in the sheet: a hole`;
  }

  /** The selected hole, as `curvesOf` has it. */
  chosenHole() {
    const hole = this.store.get("hole");
    return hole === null ? undefined : curvesOf(this.sheet).find((curve) => curve.hole === hole);
  }

  /** What has corners to drag: the selected hole, else the outline. */
  chosen() {
    return this.chosenHole() ?? curvesOf(this.sheet)[0];
  }

  /** Handles of the curves: all of the outline, which is moved at an end, and of the selected hole, the centres of others. */
  #handles() {
    return curvesOf(this.sheet).flatMap((curve) => {
      const { hole, kind, centre, axes, turn, points } = curve;
      const end = (axis, length) => sum(centre, direction(turn + 90 * axis).map((value) => value * length));
      const middle = { curve, part: "centre", at: hole === null && axes ? end(0, -axes[0]) : centre };
      if (hole !== null && hole !== this.store.get("hole")) return [middle];
      if (axes) {
        const ends = [0, 1].map((axis) => ({ curve, part: axis, at: end(axis, axes[axis]) }));
        const turned = { curve, part: "turn", at: end(0, axes[0] + this.plan.px(TURN_PX)), from: ends[0].at };
        return [middle, ...ends, ...(axes[0] === axes[1] ? [] : [turned])];
      }
      const corners = points.map((at, index) => ({ curve, part: "point", index, at }));
      const isLong = (index) => kind === "polygon" && 2 * edgeOf(points, index).half > this.plan.px(LEAST_EDGE_PX);
      const bends = corners
        .filter(({ index }) => isLong(index))
        .map(({ index }) => ({ curve, part: "bulge", index, at: middleOf(curve, index) }));
      return [...(hole === null ? [] : [middle]), ...bends, ...corners];
    });
  }

  /** A handle, an edge to add a corner to, or the hole under the pointer. */
  #under(event) {
    const reach = this.plan.px(event.isTouch ? 2 * GRIP_PX : GRIP_PX);
    const handle = nearest(this.#handles().map((one) => ({ ...one, away: distance(event.at, one.at) })), reach);
    if (handle) return handle;
    const curves = curvesOf(this.sheet);
    const edges = curves
      .filter(({ hole, points }) => points && (hole === null || hole === this.store.get("hole")))
      .map((curve) => ({ curve, ...nearestOn(curve, event.at) }));
    const edge = nearest(edges.map((one) => ({ ...one, away: one.distance })), reach);
    if (edge) return edge;
    const curve = curves.find(({ hole, ring }) => hole !== null && isInside(event.at, ring));
    return curve ? { curve, part: "centre" } : {};
  }

  down(event) {
    const sheet = this.sheet;
    let { curve, part, index, edge, point } = this.#under(event);
    if (edge !== undefined) {
      const more = morePoints(curve, edge, roundPoint(point));
      this.#refusal(sheet, withCurve(sheet, curve, more), curve.hole);
      [curve, part, index] = [{ ...curve, ...more }, "point", edge + 1];
    }
    this.store.set({ corner: part === "point" ? index : null, hole: curve?.hole ?? null });
    this.drag = { curve, part, index, start: event.at, sheet };
  }

  move(event) {
    if (!this.drag) return;
    const { curve, start, sheet } = this.drag;
    if (!this.edits.isOpen && distance(event.at, start) < this.plan.px(CLICK_PX)) return;
    if (curve) return void this.#refusal(sheet, withCurve(sheet, curve, this.#dragged(event)), curve.hole);
    const centre = snapped({ ...event, at: start }, this.plan, { points: this.#stars() }).at;
    const radius = Math.max(LEAST_RADIUS_MM, Math.round(2 * distance(event.at, centre)) / 2);
    this.#refusal(sheet, withHole(sheet, centre, [radius, radius]), holesOf(sheet).length);
  }

  #stars() {
    return this.drag.sheet.stars.map(({ at }) => ({ at, kind: "star" }));
  }

  /** What a drag changes of its curve. */
  #dragged(event) {
    const { curve, part, index, start } = this.drag;
    const { centre, axes, turn, points, bulges } = curve;
    const snap = (at, options = {}) => snapped({ ...event, at }, this.plan, options).at;
    const along = (from, way) => snap([dot(difference(event.at, from), way), 0])[0];
    if (part === "centre") return { centre: snap(sum(centre, difference(event.at, start)), { points: this.#stars() }) };
    if (part === "point") return { points: points.with(index, snap(event.at, { alignTo: points.toSpliced(index, 1) })) };
    if (part === "bulge") {
      const { middle, out } = edgeOf(points, index);
      return { bulges: bulges.with(index, along(middle, out)) };
    }
    if (part === "turn") {
      const [x, y] = difference(event.at, centre);
      const step = this.store.get("snap") === event.alt ? 0.1 : TURN_STEP_DEG;
      return { turn: round(step * Math.round((180 * Math.atan2(y, x)) / Math.PI / step), 1) };
    }
    const [isAlone, other] = [axes[0] !== axes[1] || event.shift, axes[1 - part]];
    const length = Math.max(1, Math.abs(along(centre, direction(turn + 90 * part))));
    return { axes: isAlone ? axes.with(part, clamp(length, other / MAX_ASPECT, other * MAX_ASPECT)) : [length, length] };
  }

  /** Sends a change of curves and selects its hole, unless the server would refuse it; returns why then. */
  #refusal(sheet, [changes, local], hole) {
    const refusal = refusalOf(sheet, local);
    if (refusal) return refusal;
    this.edits.begin();
    this.edits.design(changes, local);
    this.store.set({ hole });
    return null;
  }

  /** The first of some changes, each made when it is tried, that is not refused, as one step; the page says why if all are. */
  #once(sheet, changes, hole) {
    let refusal;
    changes.some((make) => !(refusal = this.#refusal(sheet, make(), hole)));
    this.edits.end();
    if (refusal) toast(refusal, { isBad: true });
    return !refusal;
  }

  /** The outline, or a hole, with other values of its curve. */
  setCurve(curve, change) {
    const sheet = this.sheet;
    return this.#once(sheet, [() => withCurve(sheet, curve, change)], curve.hole);
  }

  /** A round hole at the star of the keyboard, or as near to the middle of the sheet as there is room. */
  addHole(star = null) {
    const sheet = this.sheet;
    const radius = Math.max(LEAST_RADIUS_MM, Math.round(0.4 * sheet.spacing));
    const stars = sheet.stars.map(({ at }) => at).sort((a, b) => distance(a, sheet.centre) - distance(b, sheet.centre));
    const places = star ? [star.at] : [sheet.centre, ...stars];
    const changes = places.map((at) => () => withHole(sheet, at, [radius, radius]));
    return this.#once(sheet, changes, holesOf(sheet).length);
  }

  removeHole() {
    const sheet = this.sheet;
    this.edits.once((edits) => edits.design(...withoutHole(sheet, this.chosenHole())));
    this.store.set({ hole: null, support: null }); // the number of a support may have changed
  }

  hover(event) {
    if (!this.sheet) return;
    const { curve, edge, point } = this.#under(event);
    this.ghost = edge === undefined ? null : point;
    this.plan.canvas.style.cursor = this.ghost ? "copy" : curve ? "move" : "crosshair";
    this.plan.invalidate();
  }

  key(event) {
    const { star } = this;
    const corner = this.store.get("corner");
    const hole = this.chosenHole();
    const step = signOf(event);
    if (event.key === "Insert" && corner !== null) return this.addCorner(corner);
    if (event.key === "Enter" && star) return this.addHole(star) || true;
    if (step && hole?.axes) {
      if (Math.min(...hole.axes) + step >= 1) this.setCurve(hole, { axes: hole.axes.map((value) => value + step) });
      return true;
    }
    if (!isDelete(event)) return false;
    if (hole && !hole.points?.[corner]) this.removeHole();
    else this.removeCorner();
    return true;
  }

  /** A corner in the middle of the edge after a corner. */
  addCorner(index) {
    const curve = this.chosen();
    if (!curve.points?.[index]) return false;
    this.setCurve(curve, morePoints(curve, index, middleOf(curve, index)));
    this.store.set({ corner: index + 1 });
    return true;
  }

  removeCorner() {
    const curve = this.chosen();
    const index = this.store.get("corner");
    if (!curve.points?.[index] || curve.points.length <= 3) return;
    this.setCurve(curve, fewerPoints(curve, index));
    this.store.set({ corner: null, support: null }); // a support may have gone
  }

  setBorder(shape) {
    const border = borderOf(this.sheet.design, shape);
    this.edits.once((edits) => edits.design({ border }));
  }

  draw(context, plan, colour) {
    const paint = { context, colour };
    const chosen = this.chosen();
    const corner = this.store.get("corner");
    for (const star of this.sheet.stars.filter(({ isCut }) => isCut)) {
      circle(context, plan, star.at, 0.46 * this.sheet.spacing, { colour: colour("warn"), width: 2, dash: [2, 4] });
    }
    if (chosen.hole !== null) polyline(context, plan, chosen.ring, { isClosed: true, colour: colour("accent"), width: 2 });
    for (const { curve, part, index, at, from } of this.#handles()) {
      const isChosen = part === "centre" || (part === "point" && index === corner && curve.hole === chosen.hole);
      if (from) polyline(context, plan, [from, at], { colour: colour("accent"), width: 1 });
      if (part === "point") square(paint, plan.toScreen(at), isChosen ? "accent" : "paper");
      else dotAt(paint, plan.toScreen(at), isChosen ? "accent" : "paper", part === "bulge" ? 4 : 5);
    }
    if (this.ghost) dotAt(paint, plan.toScreen(this.ghost), "accent");
    if (!this.drag || !this.edits.isOpen) return;
    const { part, index } = this.drag;
    const isDragged = (one) => one.curve.hole === chosen.hole && one.part === part && one.index === index;
    const { at } = this.#handles().find(isDragged) ?? { at: chosen.centre };
    const place = ([x, y]) => `${fixed(x)}, ${fixed(y)} mm`;
    const said = {
      point: () => place(at),
      centre: () => place(chosen.centre),
      bulge: () => mm(chosen.bulges[index]),
      turn: () => `${fixed(chosen.turn)}°`,
    };
    if (part === "point") drawCross(paint, plan, at);
    this.say(paint, said[part]?.() ?? sizeOf(chosen), at);
  }
}

/** The size of a curve in a few words. */
export function sizeOf({ axes, kind, points }) {
  if (!axes) return plural(points.length, kind === "spline" ? "point" : "corner");
  const [width, height] = axes.map((value) => fixed(2 * value));
  return width === height ? `⌀ ${width} mm` : `${width} × ${height} mm`;
}

function dotAt({ context, colour }, place, fill, radius = 5) {
  disc(context, place, radius, { fill: colour(fill), colour: colour("accent"), width: 2 });
}

function square({ context, colour }, [x, y], fill) {
  context.beginPath();
  context.rect(x - 4.5, y - 4.5, 9, 9);
  draw(context, { fill: colour(fill), colour: colour("accent"), width: 2 });
}

/** Lines through a place, for the eye. */
function drawCross({ context, colour }, plan, [x, y]) {
  for (const [dx, dy] of [[3000, 0], [0, 3000]]) {
    polyline(context, plan, [[x - dx, y - dy], [x + dx, y + dy]], { colour: colour("accent"), alpha: 0.4 });
  }
}

/** The kind of regular shape that the outline is, and its size; without a kind the size of any outline, in whole mm. */
export function regularOf(sheet) {
  const { border = {} } = sheet.design;
  const { rings, rectangle_mm, circle_mm, polygon_mm, bulge_mm, spline_mm } = border;
  const table = JSON.stringify({ rings, rectangle_mm, circle_mm, polygon_mm, bulge_mm, spline_mm });
  const [{ axes }] = curvesOf(sheet);
  const [width, height] = rectangle_mm ?? (axes ? axes.map((half) => 2 * half) : sheet.box.size.map((side) => round(side)));
  const [first, ...others] = polygon_mm ?? [[0, 0]];
  const found = [
    { kind: "hexagon", rings },
    { kind: "rectangle", width, height },
    { kind: "circle", width, height },
    { kind: "polygon", width: round(2 * first[1]), sides: others.length + 1 },
    { kind: "l", width, height, leg: round((others[1]?.[1] ?? 0) - first[1]) },
  ].find((one) => table !== "{}" && JSON.stringify(regularShape(one.kind, one)) === table);
  return { width: Math.round(width), height: Math.round(height), leg: null, ...found };
}

/** The table of a regular shape of a size, in mm. */
export function regularShape(kind, { width, height, leg, sides, rings }) {
  if (kind === "rectangle") return { rectangle_mm: [width, height] };
  if (kind === "hexagon") return { rings };
  if (kind === "l") {
    const [x, y] = [width / 2, height / 2];
    const least = Math.min(width, height);
    const [right, upper] = [x, y].map((half) => (leg < least && leg ? leg : least / 2) - half); // the inner corner
    return { polygon_mm: [[-x, -y], [x, -y], [x, upper], [right, upper], [right, y], [-x, y]] };
  }
  if (kind === "circle") return { circle_mm: circleOf([0, 0], [width / 2, height / 2]) };
  return { polygon_mm: ellipse([0, 0], [width / 2, width / 2], { count: sides, start: Math.PI / 2 }) };
}
