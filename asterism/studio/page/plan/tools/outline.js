// The outline: drag corners, click an edge to add one, Delete removes; snapping to other corners and whole millimetres.

import { crossesItself, nearestEdge, nearestIndex, regularPolygon, roundPoint } from "../../geometry.js";
import { polyline, snapped } from "./common.js";
import { label } from "../draw.js";
import { fixed } from "../../format.js";

const GRIP_PX = 12;

export class OutlineTool {
  cursor = "crosshair";
  #corners = null; // while dragging
  #index = -1;
  #edge = null;
  #isOriginal = false;

  constructor({ plan, store, edits }) {
    Object.assign(this, { plan, store, edits });
  }

  get hint() {
    return "Drag corners\u00a0· click an edge to add one";
  }

  down(event) {
    const corners = this.store.get("sheet").outline.map((corner) => [...corner]);
    const { index, distance: away } = nearestIndex(event.at, corners);
    const reach = this.plan.px(event.isTouch ? 2 * GRIP_PX : GRIP_PX);
    if (away < reach) this.#begin(corners, index);
    else {
      const edge = nearestEdge(event.at, corners);
      if (edge.distance > reach) return void this.store.set({ corner: null });
      corners.splice(edge.edge + 1, 0, roundPoint(edge.point));
      this.#begin(corners, edge.edge + 1);
      this.#send();
    }
  }

  #begin(corners, index) {
    this.edits.begin();
    this.#corners = corners;
    this.#index = index;
    this.store.set({ corner: index });
  }

  move(event) {
    if (!this.#corners) return;
    const others = this.#corners.filter((_, k) => k !== this.#index);
    const { at } = snapped(event, this.plan, { alignTo: others });
    const before = this.#corners[this.#index];
    this.#corners[this.#index] = at;
    if (crossesItself(this.#corners)) this.#corners[this.#index] = before;
    else this.#send();
  }

  up() {
    if (!this.#corners) return;
    this.#corners = null;
    this.edits.end();
  }

  cancel() {
    this.#corners = null;
    this.edits.cancel();
  }

  #send() {
    const corners = this.#corners.map((corner) => [...corner]);
    this.edits.design(
      borderOf(this.store.get("sheet").design, { polygon_mm: corners.map((corner) => roundPoint(corner)) }),
      { outline: corners },
    );
  }

  hover(event) {
    const corners = this.store.get("sheet")?.outline ?? [];
    const reach = this.plan.px(GRIP_PX);
    const near = nearestIndex(event.at, corners);
    const edge = near.distance > reach && corners.length ? nearestEdge(event.at, corners) : null;
    this.#edge = edge && edge.distance < reach ? edge.point : null;
    this.plan.canvas.style.cursor = near.distance < reach ? "move" : this.#edge ? "copy" : "default";
    this.plan.invalidate();
  }

  leave() {
    this.#edge = null;
    this.plan.invalidate();
  }

  key(event) {
    const corner = this.store.get("corner");
    if (event.key === "Insert" && corner !== null) return this.addCorner(corner);
    if (event.key !== "Delete" && event.key !== "Backspace") return false;
    this.removeCorner();
    return true;
  }

  /** A corner in the middle of the edge after a corner. */
  addCorner(index) {
    const corners = this.store.get("sheet").outline.map((corner) => [...corner]);
    const [one, next] = [corners[index], corners[(index + 1) % corners.length]];
    if (!one) return false;
    corners.splice(index + 1, 0, [(one[0] + next[0]) / 2, (one[1] + next[1]) / 2]);
    this.setCorners(corners);
    this.store.set({ corner: index + 1 });
    return true;
  }

  removeCorner() {
    const corners = this.store.get("sheet").outline.map((corner) => [...corner]);
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

  setBorder(border, corners = null) {
    const { design } = this.store.get("sheet");
    this.edits.once((edits) => edits.design(borderOf(design, border), corners ? { outline: corners } : {}));
  }

  draw(context, plan, colour) {
    const { outline } = this.store.get("sheet");
    const chosen = this.store.get("corner");
    for (const [k, corner] of outline.entries()) {
      const [x, y] = plan.toScreen(corner);
      context.fillStyle = colour(k === chosen ? "accent" : "paper");
      context.strokeStyle = colour("accent");
      context.lineWidth = 2;
      context.fillRect(x - 4.5, y - 4.5, 9, 9);
      context.strokeRect(x - 4.5, y - 4.5, 9, 9);
    }
    if (this.#edge) {
      const [x, y] = plan.toScreen(this.#edge);
      context.beginPath();
      context.arc(x, y, 4.5, 0, 2 * Math.PI);
      context.fillStyle = colour("accent");
      context.fill();
    }
    if (this.#corners) {
      const [px, py] = this.#corners[this.#index];
      const [x, y] = plan.toScreen([px, py]);
      context.strokeStyle = colour("accent");
      context.globalAlpha = 0.4;
      context.lineWidth = 1;
      for (const end of [
        [
          [px - 3000, py],
          [px + 3000, py],
        ],
        [
          [px, py - 3000],
          [px, py + 3000],
        ],
      ]) {
        polyline(context, plan, end);
        context.stroke();
      }
      context.globalAlpha = 1;
      label({ context, colour }, `${fixed(px)}, ${fixed(py)} mm`, [x + 12, y - 12], "left", "accent");
    }
  }
}

/** The change of the design's border table that keeps its margins. */
function borderOf(design, shape) {
  const { rings, rectangle_mm, polygon_mm, ...rest } = design.border ?? {};
  return { border: { ...rest, ...shape } };
}

/** Regular shapes of about the present size. */
export function regularShape(kind, { width, height, sides, rings }) {
  if (kind === "rectangle") return { rectangle_mm: [width, height] };
  if (kind === "hexagon") return { rings };
  return { polygon_mm: regularPolygon(sides, width / 2) };
}
