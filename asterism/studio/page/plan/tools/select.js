// Selection: click or lasso, with Shift also, with Alt no longer; double click for the ring.

import { distance, isInside } from "../../geometry.js";
import { draw, polyline } from "../pen.js";
import { PlanTool } from "./common.js";

const CLICK_PX = 4;

/** `drag`: the path of the lasso. */
export class SelectTool extends PlanTool {
  cursor = "default";
  hint = "Click or lasso\u00a0· Shift adds\u00a0· Alt takes away\u00a0· double click: the ring";

  down(event) {
    this.drag = [event.at];
  }

  move(event) {
    if (!this.drag) return;
    this.drag.push(event.at);
    this.plan.invalidate();
  }

  up(event) {
    if (!this.drag) return;
    const path = this.drag;
    this.drag = null;
    const sheet = this.sheet;
    const isLasso = Math.max(...path.map((at) => distance(at, path[0]))) > this.plan.px(CLICK_PX);
    const stars = isLasso ? sheet.stars.filter((star) => isInside(star.at, path)) : [sheet.starAt(event.at)].filter(Boolean);
    this.#select(stars.map((star) => star.key), event, !isLasso);
    this.plan.invalidate();
  }

  double(event) {
    const sheet = this.sheet;
    const star = sheet.starAt(event.at);
    if (star) this.#select(ringKeys(sheet, star), event, false);
  }

  hover(event) {
    const star = this.sheet?.starAt(event.at);
    this.store.set({ hover: star?.key ?? null });
  }

  leave() {
    this.store.set({ hover: null });
  }

  #select(keys, event, isToggled) {
    const selection = selected(this.store, keys, event, isToggled);
    this.store.set({ selection, cursor: keys.at(-1) ?? this.store.get("cursor") });
  }

  draw(context, plan, colour) {
    if (!this.drag || this.drag.length < 2) return;
    const accent = colour("accent");
    polyline(context, plan, this.drag, { isClosed: true, fill: accent, alpha: 0.08 });
    draw(context, { colour: accent, width: 1.5, dash: [4, 3] });
  }
}

/** The selection with some stars: these alone, with Shift also these, with Alt without these. */
export function selected(store, keys, { shift, alt }, isToggled) {
  const usual = store.get("tool") === "select" ? store.get("selecting") : "new"; // its choice stands in that tool's panel
  const way = alt ? "less" : shift ? "more" : usual;
  const selection = new Set(way === "new" ? [] : store.get("selection"));
  for (const key of keys) {
    if (way === "less" || (way === "more" && isToggled && selection.has(key))) selection.delete(key);
    else selection.add(key);
  }
  return selection;
}

export function ringKeys(sheet, star) {
  const ring = sheet.ring(star);
  return sheet.stars.filter((other) => sheet.ring(other) === ring).map((other) => other.key);
}

/** Stars with the same sizes as any of the selected ones. */
export function sameSizeKeys(sheet, keys) {
  const text = (star) => star.sizes.map((value) => value.toFixed(2)).join(" ");
  const chosen = [...keys].map((key) => sheet.byKey.get(key)).filter(Boolean);
  const wanted = new Set(chosen.map(text));
  return sheet.stars.filter((star) => wanted.has(text(star))).map((star) => star.key);
}
