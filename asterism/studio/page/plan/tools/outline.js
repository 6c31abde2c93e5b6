// The outline and holes: drag corners, click an edge to add one, Delete removes; circles and ellipses have handles at
// their centre and at the ends of their half axes. A drag over the sheet cuts a round hole.

import { borderOf, circleOf, curvesOf, holesOf, leavesFabric, withCurve, withHole, withoutHole } from "../../border.js";
import { clamp, crossesItself, distance, ellipse, isInside, nearestEdge, nearestIndex, roundPoint } from "../../geometry.js";
import { isDelete, signOf } from "../../dom.js";
import { toast } from "../../panels/toasts.js";
import { circle, disc, polyline } from "../pen.js";
import { PlanTool, snapped } from "./common.js";
import { fixed } from "../../format.js";

const GRIP_PX = 12;
const CLICK_PX = 4;
const LEAST_RADIUS_MM = 2; // of a hole that is drawn
const MAX_ASPECT = 20; // of the half axes of an ellipse

/**
 * `drag`: a corner, as {corners, index}; a curve, or a new hole without one, as {curve, part, start, sheet}, with the
 * sheet before. `ghost`: the place of a new corner.
 */
export class OutlineTool extends PlanTool {
  get hint() {
    const isRound = this.sheet?.design.border?.circle_mm;
    const outline = isRound ? "Drag handles\u00a0· Shift: one axis" : "Drag corners\u00a0· click an edge to add one";
    return `${outline}\u00a0· drag in the sheet: a hole`;
  }

  /** Corners of the outline; a circle has none. */
  corners() {
    const { design, outline } = this.sheet ?? { outline: [] };
    return design?.border?.circle_mm ? [] : outline.map((corner) => [...corner]);
  }

  /** The selected hole, as `curvesOf` has it. */
  chosenHole() {
    const hole = this.store.get("hole");
    return hole === null ? undefined : curvesOf(this.sheet).find((curve) => curve.hole === hole);
  }

  /** Handles of the curves: all of the outline, which is moved at an end, of the selected hole, the centres of others. */
  #handles() {
    return curvesOf(this.sheet).flatMap((curve) => {
      const { hole, axes } = curve;
      const [x, y] = curve.centre;
      const handles = [{ curve, part: "centre", at: hole === null ? [x - axes[0], y] : [x, y] }];
      if (!axes || (hole !== null && hole !== this.store.get("hole"))) return handles;
      return [...handles, { curve, part: 0, at: [x + axes[0], y] }, { curve, part: 1, at: [x, y + axes[1]] }];
    });
  }

  /** A corner, a handle, an edge, or the hole under the pointer. */
  #under(event) {
    const reach = this.plan.px(event.isTouch ? 2 * GRIP_PX : GRIP_PX);
    const corners = this.corners();
    const corner = nearestIndex(event.at, corners);
    if (corner.distance < reach) return { corner: corner.index };
    const handles = this.#handles();
    const places = handles.map(({ at }) => at);
    const handle = nearestIndex(event.at, places);
    if (handle.distance < reach) return handles[handle.index];
    const edge = nearestEdge(event.at, corners);
    if (edge?.distance < reach) return { edge };
    const curve = curvesOf(this.sheet).find(({ hole, ring }) => hole !== null && isInside(event.at, ring));
    return curve ? { curve, part: "centre" } : {};
  }

  down(event) {
    const corners = this.corners();
    const { corner, edge, curve, part } = this.#under(event);
    if (corner !== undefined) this.#begin(corners, corner);
    else if (edge) {
      corners.splice(edge.edge + 1, 0, roundPoint(edge.point));
      this.#begin(corners, edge.edge + 1);
      this.#send();
    } else {
      this.store.set({ corner: null, hole: curve?.hole ?? null });
      this.drag = { curve, part, start: event.at, sheet: this.sheet };
    }
  }

  #begin(corners, index) {
    this.edits.begin();
    this.drag = { corners, index };
    this.store.set({ corner: index, hole: null });
  }

  move(event) {
    if (!this.drag) return;
    const { corners, index } = this.drag;
    if (!corners) return this.#moveCurve(event);
    const { at } = snapped(event, this.plan, { alignTo: corners.toSpliced(index, 1) });
    const before = corners[index];
    corners[index] = at;
    if (crossesItself(corners)) corners[index] = before;
    else this.#send();
  }

  #moveCurve(event) {
    const { curve, part, start, sheet } = this.drag;
    if (!this.edits.isOpen && distance(event.at, start) < this.plan.px(CLICK_PX)) return;
    const points = sheet.stars.map(({ at }) => ({ at, kind: "star" }));
    const snap = (at, isGrid) => snapped({ ...event, at }, this.plan, isGrid ? {} : { points }).at;
    if (!curve) {
      const centre = snap(start);
      const radius = Math.max(LEAST_RADIUS_MM, Math.round(2 * distance(event.at, centre)) / 2);
      return this.#change(sheet, withHole(sheet, centre, [radius, radius]), holesOf(sheet).length);
    }
    let { centre, axes } = curve;
    if (part === "centre") centre = snap(centre.map((value, axis) => value + event.at[axis] - start[axis]));
    else {
      const [isAlone, other] = [axes[0] !== axes[1] || event.shift, axes[1 - part]];
      const length = Math.max(1, Math.abs(snap(event.at, true)[part] - centre[part]));
      axes = isAlone ? axes.with(part, clamp(length, other / MAX_ASPECT, other * MAX_ASPECT)) : [length, length];
    }
    this.#change(sheet, withCurve(sheet, curve, { centre, axes }), curve.hole);
  }

  /** Sends a change of curves if it leaves fabric beside them, and selects its hole. Returns whether it does. */
  #change(sheet, [changes, local], hole) {
    if (!leavesFabric(sheet, local)) return false;
    this.edits.begin();
    this.edits.design(changes, local);
    this.store.set({ hole });
    return true;
  }

  /** The first of some changes, each made when it is tried, that leaves fabric, as one step; the page says if none does. */
  #once(sheet, changes, hole) {
    const isChanged = changes.some((make) => this.#change(sheet, make(), hole));
    this.edits.end();
    if (!isChanged) toast(`No room: a hole needs ${sheet.tipMargin} mm of fabric around it.`, { isBad: true });
    return isChanged;
  }

  /** The outline, or a hole, at another place or with other half axes. */
  setCurve(curve, change) {
    const sheet = this.sheet;
    return this.#once(sheet, [() => withCurve(sheet, curve, { ...curve, ...change })], curve.hole);
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

  #send() {
    const corners = this.drag.corners.map((corner) => [...corner]);
    const border = borderOf(this.sheet.design, { polygon_mm: corners.map((corner) => roundPoint(corner)) });
    this.edits.design({ border }, { outline: corners });
  }

  hover(event) {
    if (!this.sheet) return;
    const { corner, edge, curve } = this.#under(event);
    this.ghost = edge?.point ?? null;
    this.plan.canvas.style.cursor = edge ? "copy" : corner !== undefined || curve ? "move" : "crosshair";
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
    if (hole) this.removeHole();
    else this.removeCorner();
    return true;
  }

  /** A corner in the middle of the edge after a corner. */
  addCorner(index) {
    const corners = this.corners();
    const [one, next] = [corners[index], corners[(index + 1) % corners.length]];
    if (!one) return false;
    corners.splice(index + 1, 0, [(one[0] + next[0]) / 2, (one[1] + next[1]) / 2]);
    this.setCorners(corners);
    this.store.set({ corner: index + 1 });
    return true;
  }

  removeCorner() {
    const corners = this.corners();
    const index = this.store.get("corner");
    if (index === null || corners.length <= 3 || !corners[index]) return;
    corners.splice(index, 1);
    this.setCorners(corners);
    this.store.set({ corner: null });
  }

  /** Another outline in one step. */
  setCorners(corners) {
    this.setBorder({ polygon_mm: corners.map((corner) => roundPoint(corner)) }, corners);
  }

  setBorder(shape, corners = null) {
    const border = borderOf(this.sheet.design, shape);
    this.edits.once((edits) => edits.design({ border }, corners ? { outline: corners } : {}));
  }

  draw(context, plan, colour) {
    const paint = { context, colour };
    const chosen = this.store.get("corner");
    context.lineWidth = 2;
    context.strokeStyle = colour("accent");
    for (const [k, corner] of this.corners().entries()) {
      const [x, y] = plan.toScreen(corner);
      context.fillStyle = colour(k === chosen ? "accent" : "paper");
      context.fillRect(x - 4.5, y - 4.5, 9, 9);
      context.strokeRect(x - 4.5, y - 4.5, 9, 9);
    }
    for (const star of this.sheet.stars.filter(({ isCut }) => isCut)) {
      circle(context, plan, star.at, 0.46 * this.sheet.spacing, { colour: colour("warn"), width: 2, dash: [2, 4] });
    }
    const hole = this.chosenHole();
    if (hole) polyline(context, plan, hole.ring, { isClosed: true, colour: colour("accent"), width: 2 });
    for (const { part, at } of this.#handles()) dot(paint, plan.toScreen(at), part === "centre" ? "accent" : "paper");
    if (this.ghost) dot(paint, plan.toScreen(this.ghost), "accent");
    const { corners, index, part: dragged } = this.drag ?? {};
    const place = (at) => `${at.map((value) => fixed(value)).join(", ")} mm`;
    if (corners) {
      drawCross(paint, plan, corners[index]);
      this.say(paint, place(corners[index]), corners[index]);
    } else if (this.drag && this.edits.isOpen) {
      const curve = curvesOf(this.sheet).find((one) => one.hole === this.store.get("hole"));
      if (curve) this.say(paint, dragged === "centre" ? place(curve.centre) : sizeOf(curve), curve.centre);
    }
  }
}

/** The size of a curve in a few words. */
export function sizeOf({ axes, ring }) {
  if (!axes) return `${ring.length} corners`;
  const [width, height] = axes.map((value) => fixed(2 * value));
  return width === height ? `⌀ ${width} mm` : `${width} × ${height} mm`;
}

function dot({ context, colour }, place, fill) {
  disc(context, place, 5, { fill: colour(fill), colour: colour("accent"), width: 2 });
}

/** Lines through a place, for the eye. */
function drawCross({ context, colour }, plan, [x, y]) {
  for (const [dx, dy] of [[3000, 0], [0, 3000]]) {
    polyline(context, plan, [[x - dx, y - dy], [x + dx, y + dy]], { colour: colour("accent"), alpha: 0.4 });
  }
}

/** The table of a regular shape of a size, in mm. */
export function regularShape(kind, { width, height, sides, rings }) {
  if (kind === "rectangle") return { rectangle_mm: [width, height] };
  if (kind === "hexagon") return { rings };
  if (kind === "l") {
    const [x, y] = [width / 2, height / 2];
    return { polygon_mm: [[-x, -y], [x, -y], [x, 0], [0, 0], [0, y], [-x, y]] };
  }
  if (kind === "circle") return { circle_mm: circleOf([0, 0], [width / 2, height / 2]) };
  return { polygon_mm: ellipse([0, 0], [width / 2, width / 2], { count: sides, start: Math.PI / 2 }) };
}
