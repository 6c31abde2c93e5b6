// The ruler: printed distance, and what the fabric alone contracts to.

import { distance } from "../../geometry.js";
import { fixed, mm } from "../../format.js";
import { label, polyline, segments } from "../pen.js";
import { PlanTool, snapped } from "./common.js";

export class RulerTool extends PlanTool {
  hint = "Drag to measure\u00a0· Alt: no snapping";
  #line = null;
  #isDown = false;

  down(event) {
    const at = this.#snap(event);
    this.#line = [at, at];
    this.#isDown = true;
  }

  move(event) {
    if (!this.#isDown) return;
    this.#measure(this.#snap(event));
    this.plan.invalidate();
  }

  #measure(end) {
    this.#line = [this.#line[0], end];
    this.store.set({ measured: { printed: distance(...this.#line), line: this.#line } });
  }

  up() {
    this.#isDown = false;
  }

  /** Enter measures from one star to another. */
  key(event) {
    const { star } = this;
    if (event.key !== "Enter" || !star) return false;
    if (this.#isDown) this.#measure(star.at);
    else this.#line = [star.at, star.at];
    this.#isDown = !this.#isDown;
    this.plan.invalidate();
    return true;
  }

  cancel() {
    this.#isDown = false;
    this.#line = null;
    super.cancel();
  }

  #snap(event) {
    const sheet = this.sheet;
    const points = [...sheet.outline, ...sheet.stars.map((star) => star.at)].map((at) => ({ at, kind: "point" }));
    return snapped(event, this.plan, { points }).at;
  }

  draw(context, plan, colour) {
    if (!this.#line || distance(...this.#line) === 0) return;
    const [a, b] = this.#line;
    const pen = { colour: colour("accent"), width: 2 };
    polyline(context, plan, this.#line, pen);
    const [ends, length] = [[plan.toScreen(a), plan.toScreen(b)], distance(a, b)];
    const across = [(-(b[1] - a[1]) / length) * 6, (-(b[0] - a[0]) / length) * 6];
    segments(context, ends.map(([x, y]) => [[x - across[0], y - across[1]], [x + across[0], y + across[1]]]), pen);
    const angle = (Math.atan2(b[1] - a[1], b[0] - a[0]) * 180) / Math.PI;
    const middle = [(ends[0][0] + ends[1][0]) / 2 + 10, (ends[0][1] + ends[1][1]) / 2 - 10];
    label({ context, colour }, `${mm(length)}, ${fixed(angle, 0)}°`, middle, "left", "accent");
  }
}
