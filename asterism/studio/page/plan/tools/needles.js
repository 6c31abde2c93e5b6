// Needles: click places one, drag moves it (and where it is taken to), Shift+drag or the wheel lifts it. Ctrl+click
// chooses several, which move together; so do the needles of a group.

import { isDelete } from "../../dom.js";
import { distance, edgesOf, nearest } from "../../geometry.js";
import { fixed } from "../../format.js";
import {
  isChosen,
  isPoints,
  membersOf,
  needlesOf,
  targetsOf,
  usualScale,
  withChosen,
  withCopies,
  withMoved,
  withNeedle,
  withShifted,
  withoutNeedle,
} from "../../supports.js";
import { disc } from "../pen.js";
import { PlanTool, snapped } from "./common.js";

const GRIP_PX = 12;
const LIFT_STEP_MM = 1;
const SAME_PLACE_MM = 0.5;
const LEAST_STEP_MM = 4; // from a needle to its copy

export class NeedleTool extends PlanTool {
  hint = "Click: a needle\u00a0· drag it or its cross\u00a0· Shift+drag lifts\u00a0· Ctrl+click chooses several";

  /** The needle (or its cross) under the pointer. */
  #under(event) {
    const reach = this.plan.px(event.isTouch ? 2 * GRIP_PX : GRIP_PX);
    const parts = needlesOf(this.sheet).flatMap((one) => [
      { ...one, part: "point", away: distance(event.at, one.at) },
      { ...one, part: "target", away: one.target ? distance(event.at, one.target) : Infinity },
    ]);
    return nearest(parts, reach);
  }

  down(event) {
    const sheet = this.sheet;
    const hit = this.#under(event);
    if (hit) {
      const one = { table: hit.table, point: isPoints(sheet.tables[hit.table]) ? hit.point : null };
      const support = this.store.get("support");
      if (event.control) return this.store.set({ support: withChosen(support, one) });
      const members = isChosen(support, one) ? membersOf(support) : [one];
      if (members.length === 1) this.store.set({ support: one });
      this.edits.begin();
      const isAlone = members.length === 1 && one.point !== null;
      const { tables, pins } = sheet;
      const group = isAlone ? {} : { members, tables, pins };
      this.drag = { ...hit, start: event.at, pixel: event.pixel, scale: usualScale(sheet), ...group };
      return;
    }
    this.edits.begin();
    const { at } = this.#snap(event);
    const target = this.#target(at);
    const { tables, support } = withNeedle(sheet.tables, sheet.pins, at, target);
    this.store.set({ support });
    this.drag = { ...support, part: "point", at, target, start: at, pixel: event.pixel, scale: usualScale(sheet) };
    this.#send(tables);
  }

  move(event) {
    if (!this.drag) return;
    const { part, at, target, start, pixel, scale, members, tables, pins } = this.drag;
    const sheet = this.sheet;
    const height = Math.max(0, Math.round(2 * (target[2] + this.plan.px(pixel[1] - event.pixel[1]))) / 2);
    if (members) {
      const step = event.shift ? [0, 0, height - target[2]] : [event.at[0] - start[0], event.at[1] - start[1], 0];
      return this.#send(withShifted(tables, pins, members, step));
    }
    let change;
    if (event.shift) change = { target: [target[0], target[1], height] };
    else if (part === "target") change = { target: [event.at[0], event.at[1], target[2]] };
    else {
      const moved = this.#snap({ ...event, at: [at[0] + event.at[0] - start[0], at[1] + event.at[1] - start[1]] }).at;
      change = {
        at: moved,
        target: [target[0] + scale * (moved[0] - at[0]), target[1] + scale * (moved[1] - at[1]), target[2]],
      };
    }
    this.#send(withMoved(sheet.tables, sheet.pins, this.drag, change));
  }

  hover(event) {
    const hit = this.#under(event);
    this.ghost = hit ? null : this.#snap(event);
    this.plan.canvas.style.cursor = hit ? "move" : "crosshair";
    this.plan.invalidate();
  }

  wheel(event) {
    if (!event.altKey) return false;
    return this.lift(event.deltaY < 0 ? LIFT_STEP_MM : -LIFT_STEP_MM);
  }

  key(event) {
    const step = { PageUp: LIFT_STEP_MM, PageDown: -LIFT_STEP_MM }[event.key];
    if (step) return this.lift(step);
    if (isDelete(event)) return this.remove();
    if (event.key === "Enter") return this.placeAtStar();
    return false;
  }

  /** A needle at the star of the keyboard, or the needle that is there. */
  placeAtStar() {
    const { sheet, star } = this;
    if (!star) return false;
    const there = this.#under({ at: star.at });
    if (there && distance(there.at, star.at) < SAME_PLACE_MM) {
      const point = isPoints(sheet.tables[there.table]) ? there.point : null;
      this.store.set({ support: { table: there.table, point } });
      return true;
    }
    const { tables, support } = withNeedle(sheet.tables, sheet.pins, star.at, this.#target(star.at));
    this.edits.once(() => this.#send(tables));
    this.store.set({ support });
    return true;
  }

  /** Where the needle of a printed place stands at first. */
  #target(at) {
    const scale = usualScale(this.sheet);
    return [scale * at[0], scale * at[1], 0];
  }

  lift(step) {
    const sheet = this.sheet;
    const members = membersOf(this.store.get("support")).filter(({ table }) => sheet.tables[table]);
    if (!members.length) return false;
    this.edits.once(() => this.#send(withShifted(sheet.tables, sheet.pins, members, [0, 0, step])));
    return true;
  }

  /** The chosen needles once more, nearer to the middle of the sheet; the copies are chosen. */
  duplicate() {
    const sheet = this.sheet;
    const members = membersOf(this.store.get("support")).filter(({ table }) => isPoints(sheet.tables[table] ?? {}));
    if (!members.length) return;
    const [x, y] = sheet.tables[members[0].table].points_mm[members[0].point];
    const inwards = [0.25 * (sheet.centre[0] - x), 0.25 * (sheet.centre[1] - y)];
    const step = Math.hypot(...inwards) > LEAST_STEP_MM ? inwards : [LEAST_STEP_MM, 0];
    const { tables, copies } = withCopies(sheet.tables, sheet.pins, members, step, usualScale(sheet));
    this.edits.once(() => this.#send(tables));
    const [first, ...also] = copies;
    this.store.set({ support: { ...first, also } });
  }

  remove() {
    const sheet = this.sheet;
    const members = membersOf(this.store.get("support")).filter(({ table }) => sheet.tables[table]);
    if (!members.length) return false;
    members.sort((one, other) => other.table - one.table || other.point - one.point); // numbers before stay
    const kept = members.reduce((tables, one) => withoutNeedle(tables, sheet.pins, one), sheet.tables);
    this.edits.once(() => this.#send(kept));
    this.store.set({ support: null });
    return true;
  }

  #snap(event) {
    const sheet = this.sheet;
    const points = [
      ...sheet.outline.map((at) => ({ at, kind: "corner" })),
      ...sheet.printed.map((star) => ({ at: star.at, kind: "star" })),
    ];
    return snapped(event, this.plan, { points, lines: edgesOf(sheet.outline) });
  }

  #send(tables) {
    this.edits.design({ pins: tables }, { pins: tables });
  }

  draw(context, plan, colour) {
    const paint = { context, colour };
    if (this.drag && !this.drag.members) {
      const { table: number, point } = this.drag;
      const table = this.sheet.tables[number];
      if (!table?.points_mm?.[point]) return;
      const place = targetsOf(table, this.sheet.pins[number])[point];
      const said = `to ${place.map((value) => fixed(value)).join(", ")} mm`;
      this.say(paint, said, table.points_mm[point], [12, 20], "needle");
    } else if (this.ghost) {
      const { kind, at } = this.ghost;
      disc(context, plan.toScreen(at), 5, { colour: colour("needle"), width: 1.5 });
      const said = kind && kind !== "grid" ? kind : at.map((value) => fixed(value)).join(", ");
      this.say(paint, said, at, [10, -8], "muted");
    }
  }
}
