// Panel of the supports: one block for each table of the design, exact places of the selected needle.

import { button, check, choice, counted, h, hint, labelled, listItem, section, wide } from "../dom.js";
import {
  canSplit,
  isPoints,
  membersOf,
  pointsOf,
  split,
  spreadOf,
  targetsOf,
  titleOf,
  usualScale,
  withMoved,
  withShifted,
  withSpread,
  withTable,
} from "../supports.js";
import { round as rounded } from "../geometry.js";
import { numberField, rebuild } from "./fields.js";

// of the design file; `count` stands in the list of supports
const SLIDES = {
  "": "Fixed",
  plane: { text: "Slides on its height", count: "slides" },
  z: { text: "Rises and sinks", count: "rises freely" },
};

const PLACE = { min: -5000, max: 5000, step: 0.5, digits: 2 };
const ABOUT_SPREAD = "Distances on the board over those on the print. Less: the sheet rises more.";
const SPREAD = { label: "Spread on the board", unit: "", min: 0.001, max: 10, step: 0.01 };

export function needlesPanel({ store, edits, tools }, { on }) {
  const tool = tools.needles.tool;
  const body = h("div");
  const send = (pins) => edits.once(() => edits.design({ pins }, { pins }));
  const choose = (support) => store.set({ support });
  const sheet = () => store.get("sheet");
  const hold = (where) => {
    send([{ where, scale: rounded(usualScale(sheet()), 2) }]);
    choose({ table: 0, point: null });
  };

  function update() {
    if (body.contains(document.activeElement) && document.activeElement.tagName === "INPUT" && edits.isOpen) return;
    const now = sheet();
    if (!now) return;
    const { tables, design } = now;
    const support = store.get("support");
    const holdings = [
      button({ text: "Hold the outline", testid: "hold-border", onclick: () => hold("border") }),
      design.border?.circle_mm
        ? null
        : button({ text: "Hold the corners", testid: "hold-corners", onclick: () => hold("corners") }),
    ];
    rebuild(body, () => [
      counted("Supports", tables.length),
      tables.length
        ? null
        : hint("The sheet is free. Click in the plan to place needles; three or more carry a sheet. Or hold its whole edge."),
      h("ul.list", tables.map(item)),
      tables.length
        ? wide("Free the sheet", "free-sheet", () => (send([]), choose(null)), { icon: "trash" })
        : h("div.row.wrap", holdings),
      support && tables[support.table] ? chosen(now, support) : null,
    ]);
  }

  const item = (table, k) =>
    listItem({
      icon: "pin",
      text: titleOf(table, sheet().pins[k]),
      count: SLIDES[table.slide]?.count ?? (table.scale ? `× ${table.scale}` : ""),
      isCurrent: store.get("support")?.table === k,
      testid: `support-${k}`,
      onclick: () => choose({ table: k, point: isPoints(table) ? 0 : null }),
    });

  function chosen(now, support) {
    const { table: number, point } = support;
    const [table, shown] = [now.tables[number], now.pins[number]];
    const members = membersOf(support).filter(({ table: one }) => now.tables[one]);
    if (members.length > 1) return several(now, members);
    const at = point === null ? null : pointsOf(table, shown)[point];
    if (!at) return [section(titleOf(table, shown), remove("this support")), whole(now, number, table)];
    const target = targetsOf(table, shown)[point];
    const spot = (label, axis, values, key, rest = {}) =>
      numberField({
        label,
        value: values[axis],
        ...PLACE,
        testid: `needle-${key}-${"xyz"[axis]}`,
        field: key === "at" ? "pins.points_mm" : "pins.target_mm",
        onchange: (value) => send(withMoved(now.tables, now.pins, support, { [key]: values.with(axis, value) })),
        ...rest,
      });
    return [
      section(`Needle ${point + 1}`, h("span", duplicate(), remove("this needle"))),
      hint("Through the print at (dot in the plan)"),
      spot("x", 0, at, "at"),
      spot("y", 1, at, "at"),
      hint("Pinned to the board at (cross in the plan)"),
      spot("x", 0, target, "target"),
      spot("y", 1, target, "target"),
      spot("Height z", 2, target, "target", { min: 0 }),
      whole(now, number, table),
    ];
  }

  const remove = (what) =>
    button({
      icon: "trash",
      label: `Remove ${what}`,
      keys: "Delete",
      kind: "plain danger",
      testid: "remove-needle",
      onclick: () => tool.remove(),
    });
  const duplicate = () =>
    button({ icon: "copy", label: "Duplicate", kind: "plain", testid: "duplicate-needle", onclick: () => tool.duplicate() });

  /** Needles and groups that move together. */
  function several(now, members) {
    const [first] = members;
    const height = targetsOf(now.tables[first.table], now.pins[first.table])[first.point ?? 0]?.[2] ?? 0;
    return [
      section(`${members.length} chosen`, h("span", duplicate(), remove("these supports"))),
      hint("Drag one and all move; Shift+drag, PageUp and PageDown lift them."),
      numberField({
        label: "Height of the first; all are lifted by the same",
        value: height,
        ...PLACE,
        min: 0,
        testid: "several-height",
        field: "pins.target_mm",
        onchange: (value) => send(withShifted(now.tables, now.pins, members, [0, 0, value - height])),
      }),
    ];
  }

  /** What holds for all places of a table. */
  function whole(now, number, table) {
    const change = (patch) => send(withTable(now.tables, number, patch));
    const [x, y, z] = table.offset_mm ?? [0, 0, 0];
    const isList = isPoints(table) && table.points_mm.length > 1;
    const divide = () => {
      send(split(now.tables, now.pins, number));
      choose({ table: number, point: 0 });
    };
    const chooseAll = () => {
      const [first, ...also] = table.points_mm.map((_, point) => ({ table: number, point }));
      choose({ ...first, also });
    };
    const spread = (values) => [numberField({ ...SPREAD, ...values }), hint(ABOUT_SPREAD)];
    const ofTargets = () =>
      spread({
        value: spreadOf(table),
        digits: 3,
        testid: "support-spread",
        field: "pins.target_mm",
        onchange: (value) => send(withSpread(now.tables, number, value)),
      });
    const ofScale = () => [
      spread({
        value: table.scale ?? 1,
        testid: "support-scale",
        field: "pins.scale",
        onchange: (value) => change({ scale: value }),
      }),
      numberField({
        ...PLACE,
        label: "Height",
        value: z,
        digits: 1,
        testid: "support-height",
        field: "pins.offset_mm",
        onchange: (value) => change({ offset_mm: [x, y, value] }),
      }),
    ];
    const slide = choice({
      label: "Sliding",
      testid: "support-slide",
      options: SLIDES,
      value: table.slide ?? "",
      onchange: (value) => change({ slide: value || undefined }),
    });
    const later = check({
      text: "Takes hold after the release",
      value: Boolean(table.step),
      testid: "support-step",
      onchange: (value) => change({ step: value ? 1 : undefined }),
    });
    return [
      section("All places of this support"),
      canSplit(table, now.pins[number]) && wide("Split into single needles", "split-support", divide),
      isList && wide("Choose all of them", "choose-needles", chooseAll),
      table.target_mm ? isList && ofTargets() : ofScale(),
      labelled("Sliding", slide),
      later,
    ];
  }

  on(["sheet", "support"], update);
  update();
  return [body];
}
