// The brush: paints sizes of stars or rods along a stroke, or smooths them; erases, removes and restores stars.

import { QUANTITIES, fixed } from "../../format.js";
import { clamp, falloff, images } from "../../geometry.js";
import { namesWithOwn } from "../../sheet.js";
import { starsWithin } from "./common.js";
import { EVEN_MODES, StrokeTool } from "./stroke.js";

export class BrushTool extends StrokeTool {
  #kept = new Set(); // names of rods that a stroke leaves as they are

  constructor(studio) {
    super(studio, "brush");
  }

  down(event) {
    const { quantity, mode } = this.brush;
    const paints = !EVEN_MODES.includes(mode);
    // a plain plan shows lengths and widths only
    if (paints && quantity === "thickness" && this.store.get("planColour") === "none") {
      this.store.set({ planColour: "thickness" });
    }
    const { design } = this.sheet;
    this.#kept = namesWithOwn(design, QUANTITIES[quantity].key);
    super.down(event);
  }

  dab(at, event) {
    const { store, edits } = this;
    const sheet = store.get("sheet");
    if (sheet.isOfRods) return this.#paintRods(sheet, at, event);
    const { quantity, mode, radius, target, amount } = this.brush;
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
      let value = old;
      if (mode === "set") value = old + share * (target - old);
      else if (mode === "add") value = old + share * (event.alt ? -amount : amount);
      else if (mode === "smooth") value = old + share * (this.#mean(sheet, star, column) - old);
      const kept = sheet.allowed(quantity, value, store.get("inLaw"));
      if (Math.abs(kept - old) > 1e-4) values.set(star.key, kept);
    }
    if (values.size) edits.sizes(quantity, values);
  }

  #paintRods(sheet, at, event) {
    const { quantity, mode, radius, target, amount } = this.brush;
    const strength = this.strengthOf(event);
    const [low, high] = sheet.range(quantity, this.store.get("inLaw"));
    const value = mode === "add" ? (event.alt ? -amount : amount) : clamp(target, low, high);
    const brush = { size: QUANTITIES[quantity].key, mode, radius, strength, value, low, high };
    this.edits.brush(brush, images(at, this.store.get("symmetry")), this.#kept);
  }

  #mean(sheet, star, column) {
    const others = sheet.neighbours(star).filter((other) => other.isPrinted);
    if (!others.length) return star.sizes[column];
    return others.reduce((total, other) => total + other.sizes[column], 0) / others.length;
  }

  /** What the ring says. */
  said() {
    const { mode, target, amount, quantity } = this.brush;
    const { digits } = QUANTITIES[quantity];
    return {
      set: `${fixed(target, digits)} mm`,
      add: `${amount < 0 ? "−" : "+"}${fixed(Math.abs(amount), digits)} mm`,
      smooth: "smooth",
      erase: "erase",
      remove: "remove",
    }[mode];
  }
}
