// Gradients: drag a line. Linear runs along it; radial runs from its start outwards. They become the design file's own profiles.

import { clamp, difference, distance, dot, round, roundPoint } from "../../geometry.js";
import { QUANTITIES, fixed } from "../../format.js";
import { sizeAt, sizeTarget, sizeTargets } from "../../sheet.js";
import { circle, disc, label, polyline } from "../pen.js";
import { PlanTool } from "./common.js";

const GRIP_PX = 12;

export class GradientTool extends PlanTool {
  settings = { quantity: "length", from: 10, to: 4, power: 1 };
  #line = null;
  #end = -1; // which end is dragged
  #begun = null; // first end of a line by keyboard

  /** How sizes run over the sheet. */
  get kind() {
    return this.store.get("sizesKind");
  }

  /** Whether the sizes run along a line; others are typed. */
  get isLine() {
    return ["radial", "linear"].includes(this.kind);
  }

  get hint() {
    const drag = this.isLine ? "Drag from the first value to the second" : "";
    return [drag, this.path === "stars" ? "" : "click a rod to choose it"].filter(Boolean).join("\u00a0· ");
  }

  /** Path of what gets sizes in the design file. */
  get path() {
    return sizeTarget(this.sheet?.design ?? {}, this.store.get("sizesOf"));
  }

  /** Takes the profile that the design has. */
  read() {
    const sheet = this.sheet;
    const profile = sheet && sizeAt(sheet.design, this.path, QUANTITIES[this.settings.quantity].key).value;
    this.#line = this.#begun = null;
    if (profile?.profile === "radial") {
      const centre = profile.centre_mm ?? [0, 0];
      this.#line = [centre, [centre[0] + profile.over_mm, centre[1]]];
    } else if (profile?.profile === "linear") this.#line = [profile.start_mm, profile.end_mm];
    if (this.#line) {
      this.store.set({ sizesKind: profile.profile });
      Object.assign(this.settings, { from: profile.from, to: profile.to, power: profile.power ?? 1 });
    }
    this.plan.invalidate();
    return profile;
  }

  down(event) {
    const reach = this.plan.px(GRIP_PX);
    const near = this.#line ? this.#line.findIndex((end) => distance(end, event.at) < reach) : -1;
    if (near >= 0) this.#end = near;
    else {
      this.#line = [roundPoint(event.at, 1), roundPoint(event.at, 1)];
      this.#end = 1;
    }
  }

  move(event) {
    if (this.#end < 0 || !this.isLine) return;
    const moved = roundPoint(event.at, 1);
    this.#line = this.#line.map((end, k) => (k === this.#end ? moved : end));
    if (distance(...this.#line) > 1) {
      this.edits.begin(); // a click is no change
      this.apply();
    }
    this.plan.invalidate();
  }

  up() {
    if (this.#end < 0) return;
    this.#end = -1;
    this.edits.end();
    if (distance(...this.#line) > 1) return;
    const rod = this.sheet.rodTargetAt(this.#line[0], this.plan.px(GRIP_PX) / 2);
    this.read();
    if (rod) this.store.set({ sizesOf: rod }); // a click chooses a rod
  }

  cancel() {
    if (this.#end < 0) return;
    this.#end = -1;
    super.cancel();
    this.read();
  }

  /** Enter at a star begins the line there, and ends it at another one. */
  key(event) {
    const { star } = this;
    if (event.key !== "Enter" || !star || !this.isLine) return false;
    const at = roundPoint(star.at, 1);
    if (this.#begun && distance(this.#begun, at) > 1) {
      this.#line = [this.#begun, at];
      this.#begun = null;
      this.edits.once(() => this.apply());
    } else {
      this.#begun = at;
      this.#line = [at, at];
    }
    this.plan.invalidate();
    return true;
  }

  /** Sends the profile; sizes are drawn at once. */
  apply() {
    const { kind, settings: { quantity, from, to, power } } = this;
    this.#line ??= this.#wholeSheet(kind);
    const [start, end] = this.#line;
    const over = distance(start, end);
    const profile = { profile: kind, from, to, ...(power === 1 ? {} : { power }) };
    if (kind === "radial") Object.assign(profile, { over_mm: round(over, 2), centre_mm: start });
    else Object.assign(profile, { start_mm: start, end_mm: end });
    this.edits.design(sizeChanges(this.sheet.design, this.path, quantity, profile));
    if (this.path === "stars") this.#show(start, end, over);
  }

  /** From the centre to the right end, or from end to end. */
  #wholeSheet(kind) {
    const { low, high, centre } = this.sheet.box;
    const start = kind === "radial" ? centre : [low[0], centre[1]];
    return [roundPoint(start, 1), roundPoint([high[0], centre[1]], 1)];
  }

  /** Painted stars keep their sizes; the others follow the profile. */
  #show(start, end, over) {
    const { kind, settings: { quantity, from, to, power } } = this;
    const along = difference(end, start);
    const wayTo = (at) => (kind === "radial" ? distance(at, start) : dot(difference(at, start), along) / over);
    const valueAt = (at) => from + clamp(wayTo(at) / over, 0, 1) ** power * (to - from);
    const stars = this.sheet.stars.filter(({ removed }) => !removed);
    this.edits.preview(quantity, new Map(stars.map(({ key, at }) => [key, valueAt(at)])));
  }

  /** A line along the rods that get the sizes, if that is not all of them. */
  #drawChosen(context, plan, colour) {
    const sheet = this.sheet;
    const target = sheet && sizeTargets(sheet.design).find(({ path }) => path === this.path);
    if (!target?.name) return;
    for (const rod of sheet.rods.filter(({ name }) => name === target.name)) {
      polyline(context, plan, rod.points_mm, { colour: colour("accent"), width: 2 });
    }
  }

  draw(context, plan, colour) {
    this.#drawChosen(context, plan, colour);
    if (!this.#line || !this.isLine) return;
    const [start, end] = this.#line;
    const { kind, settings: { from, to, quantity } } = this;
    const { digits } = QUANTITIES[quantity];
    const pen = { colour: colour("accent"), width: 2 };
    polyline(context, plan, [start, end], pen);
    if (kind === "radial") {
      circle(context, plan, start, distance(start, end), { ...pen, width: 1, dash: [5, 4] });
    }
    for (const [point, value] of [[start, from], [end, to]]) {
      const [x, y] = plan.toScreen(point);
      disc(context, [x, y], 6, { ...pen, fill: colour("paper") });
      label({ context, colour }, `${fixed(value, digits)} mm`, [x + 10, y - 10], "left", "accent");
    }
  }
}

/** Changes that give a quantity a new profile or number. A length in parts of the spacing is replaced. */
export function sizeChanges(design, path, quantity, value) {
  const changes = { [`${path}.${QUANTITIES[quantity].key}`]: value };
  if (quantity === "length" && design.stars?.length_fraction !== undefined) changes["stars.length_fraction"] = null;
  return changes;
}
