// The brush of weights: paints where a fit comes nearer to the target.

import { signOf } from "../../dom.js";
import { times } from "../../format.js";
import { clamp, falloff, images } from "../../geometry.js";
import { announce } from "../../panels/toasts.js";
import { label } from "../pen.js";
import { starsWithin } from "./common.js";
import { StrokeTool } from "./stroke.js";

const KEY_FACTOR = 1.5; // of + and −
const LEAST_LOG = Math.log(1.1);
const MIN_NUMBER_PX = 14; // half a cell that has room for its number

export class WeightTool extends StrokeTool {
  setting = "weightBrush";
  hint = "Paint where the fit comes nearer\u00a0· Alt: erase\u00a0· [ ] radius";

  /** + and − change the weight at the star of the keyboard. */
  key(event) {
    const { sheet, star } = this;
    if (!signOf(event)) return super.key(event);
    if (star) {
      const weight = this.#allowed(sheet, star.weight * KEY_FACTOR ** signOf(event));
      this.edits.once(() => this.edits.weigh(new Map([[star.key, weight]])));
      announce(`Weight ${times(weight)}`);
    }
    return true;
  }

  dab(at, event) {
    const sheet = this.sheet;
    const { mode, radius, weight } = this.brush;
    const values = new Map();
    for (const { star, away } of starsWithin(sheet, images(at, this.store.get("symmetry")), radius)) {
      if (mode === "erase" || event.alt) {
        if (star.weight !== 1) values.set(star.key, null);
        continue;
      }
      // weights are factors: half of the way from 1 to 9 is 3
      const share = this.strengthOf(event) * falloff(away / radius);
      const kept = this.#allowed(sheet, star.weight * (weight / star.weight) ** share);
      if (star.weight === 1 && Math.abs(Math.log(kept)) < LEAST_LOG) continue; // the rim of the brush
      if (Math.abs(kept - star.weight) > 1e-3) values.set(star.key, kept);
    }
    if (values.size) this.edits.weigh(values);
  }

  #allowed(sheet, weight) {
    return Number(clamp(weight, ...sheet.limits.design.weight).toFixed(3));
  }

  get isEven() {
    return this.brush.mode === "erase";
  }

  said() {
    return this.isEven ? "erase" : times(this.brush.weight);
  }

  draw(context, plan, colour) {
    const sheet = this.sheet;
    const reach = 0.5 * sheet.spacing * plan.scale;
    for (const star of reach < MIN_NUMBER_PX ? [] : sheet.stars) {
      if (star.weight === 1) continue;
      const [x, y] = plan.toScreen(star.at);
      label({ context, colour }, times(star.weight), [x, y + 0.72 * reach + 4], "center", "weight");
    }
    super.draw(context, plan, colour);
  }
}
