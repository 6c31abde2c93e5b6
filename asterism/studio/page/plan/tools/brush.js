// The brush: paints sizes of stars or rods along a stroke, or smooths them; erases, removes and restores stars.

import { MODES, isEven, painted } from "../../brush_modes.js";
import { QUANTITIES } from "../../format.js";
import { clamp, falloff, images } from "../../geometry.js";
import { namesWithOwn } from "../../sheet.js";
import { starsWithin } from "./common.js";
import { StrokeTool } from "./stroke.js";

export class BrushTool extends StrokeTool {
  setting = "brush";
  #kept = new Set(); // names of rods that a stroke leaves as they are

  down(event) {
    const { quantity, mode } = this.brush;
    // a plain plan shows lengths and widths only
    if (!isEven(mode) && quantity === "thickness" && this.store.get("planColour") === "none") {
      this.store.set({ planColour: "thickness" });
    }
    this.#kept = namesWithOwn(this.sheet.design, QUANTITIES[quantity].key);
    super.down(event);
  }

  dab(at, event) {
    const { sheet, store, edits } = this;
    if (sheet.isOfRods) return this.#paintRods(sheet, at, event);
    const { quantity, mode, radius } = this.brush;
    const strength = this.strengthOf(event);
    const near = starsWithin(sheet, images(at, store.get("symmetry")), radius);
    if (!near.length) return;
    const keys = (wanted) => near.filter(({ star }) => wanted(star)).map(({ star }) => star.key);
    if (mode === "remove") {
      if (event.alt) return void edits.restore(keys((star) => star.removed));
      const kept = keys((star) => !star.removed);
      if (kept.length < sheet.printed.length) edits.remove(kept);
      return;
    }
    if (mode === "erase") return void edits.reset(keys((star) => star.painted));
    const { column } = QUANTITIES[quantity];
    const values = new Map();
    for (const { star, away } of near) {
      if (star.removed) continue;
      const share = strength * falloff(away / radius);
      const old = star.sizes[column];
      const value = painted(mode, old, share, this.#value(event), () => this.#mean(sheet, star, column));
      const kept = sheet.allowed(quantity, value, store.get("inLaw"));
      if (Math.abs(kept - old) > 1e-4) values.set(star.key, kept);
    }
    if (values.size) edits.sizes(quantity, values);
  }

  #paintRods(sheet, at, event) {
    const { quantity, mode, radius } = this.brush;
    const strength = this.strengthOf(event);
    const { key: size, step } = QUANTITIES[quantity];
    const [low, high] = sheet.range(quantity, this.store.get("inLaw"));
    const value = clamp(this.#value(event), ...(MODES[mode].number?.limits([low, high], step) ?? [0, 0]));
    const brush = { size, mode, radius, strength, value, low, high };
    this.edits.brush(brush, images(at, this.store.get("symmetry")), this.#kept);
  }

  /** The mode's own number, 0 if it has none. */
  #value({ alt: isAlt }) {
    const { key, alt } = MODES[this.brush.mode].number ?? {};
    const value = this.brush[key] ?? 0;
    return isAlt && alt ? alt(value) : value;
  }

  #mean(sheet, star, column) {
    const others = sheet.neighbours(star).filter((other) => other.isPrinted);
    if (!others.length) return star.sizes[column];
    return others.reduce((total, other) => total + other.sizes[column], 0) / others.length;
  }

  get isEven() {
    return isEven(this.brush.mode);
  }

  /** What the ring says. */
  said() {
    const { mode, quantity } = this.brush;
    return MODES[mode].ring?.(this.brush, QUANTITIES[quantity].digits) ?? mode;
  }
}
