// Panel of the supports: one block for each table of the design, exact places of the selected needle.

import { button, check, choice, counted, h, hint, labelled, listItem, section } from "../dom.js";
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
import { numberField } from "./fields.js";
import { rebuild } from "../rebuild.js";

// of the design file; `count` stands in the list of supports
const SLIDES = {
  "": "Fixed",
  plane: { text: "Slides on its height", count: "slides" },
  z: { text: "Rises and sinks", count: "rises freely" },
};

export function needlesPanel({ store, edits, tools }, { on }) {
  const tool = tools.needles.tool;
  const body = h("div", {});
  const send = (tables) => edits.once(() => edits.design({ pins: tables }, { pins: tables }));
  const sheet = () => store.get("sheet");
  const hold = (where) => {
    send([{ where, scale: rounded(usualScale(sheet()), 2) }]);
    store.set({ support: { table: 0, point: null } });
  };

  function update() {
    if (body.contains(document.activeElement) && document.activeElement.tagName === "INPUT" && edits.isOpen) return;
    const now = sheet();
    if (!now) return;
    const parts = [counted("Supports", now.tables.length)];
    if (!now.tables.length)
      parts.push(
        hint("The sheet is free. Click in the plan to place needles; three or more carry a sheet. Or hold its whole edge."),
      );
    parts.push(
      h("ul", { class: "list" }, now.tables.map(item)),
      now.tables.length
        ? button({
            icon: "trash",
            text: "Free the sheet",
            kind: "wide",
            testid: "free-sheet",
            onclick: () => (send([]), store.set({ support: null })),
          })
        : h(
            "div",
            { class: "row wrap" },
            button({ text: "Hold the outline", testid: "hold-border", onclick: () => hold("border") }),
            now.design.border?.circle_mm
              ? null
              : button({ text: "Hold the corners", testid: "hold-corners", onclick: () => hold("corners") }),
          ),
    );
    const support = store.get("support");
    if (support && now.tables[support.table]) parts.push(...chosen(now, support));
    rebuild(body, () => parts);
  }

  const item = (table, k) =>
    listItem({
      icon: "pin",
      text: titleOf(table, sheet().pins[k]),
      count: SLIDES[table.slide]?.count ?? (table.scale ? `× ${table.scale}` : ""),
      isCurrent: store.get("support")?.table === k,
      testid: `support-${k}`,
      onclick: () => store.set({ support: { table: k, point: isPoints(table) ? 0 : null } }),
    });

  function chosen(now, support) {
    const table = now.tables[support.table];
    const shown = now.pins[support.table];
    const parts = [];
    const members = membersOf(support).filter(({ table: one }) => now.tables[one]);
    if (members.length > 1) return several(now, members);
    if (support.point !== null && pointsOf(table, shown)[support.point]) {
      const at = pointsOf(table, shown)[support.point];
      const target = targetsOf(table, shown)[support.point];
      const move = (change) => send(withMoved(now.tables, now.pins, support, change));
      const spot = (label, axis, values, key, low = -5000) =>
        numberField({
          label,
          value: values[axis],
          min: low,
          max: 5000,
          step: 0.5,
          digits: 2,
          testid: `needle-${key}-${"xyz"[axis]}`,
          field: key === "at" ? "pins.points_mm" : "pins.target_mm",
          onchange: (value) => move({ [key]: values.with(axis, value) }),
        }).element;
      parts.push(
        section(`Needle ${support.point + 1}`, h("span", {}, duplicate(), remove("this needle"))),
        hint("Through the print at (dot in the plan)"),
        spot("x", 0, at, "at"),
        spot("y", 1, at, "at"),
        hint("Pinned to the board at (cross in the plan)"),
        spot("x", 0, target, "target"),
        spot("y", 1, target, "target"),
        spot("Height z", 2, target, "target", 0),
      );
    } else parts.push(section(titleOf(table, shown), remove("this support")));
    parts.push(...whole(now, support.table, table));
    return parts;
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
    const height = ({ table, point }) => targetsOf(now.tables[table], now.pins[table])[point ?? 0]?.[2] ?? 0;
    const [first] = members;
    return [
      section(`${members.length} chosen`, h("span", {}, duplicate(), remove("these supports"))),
      hint("Drag one and all move; Shift+drag, PageUp and PageDown lift them."),
      numberField({
        label: "Height of the first; all are lifted by the same",
        value: height(first),
        min: 0,
        max: 5000,
        step: 0.5,
        digits: 2,
        testid: "several-height",
        field: "pins.target_mm",
        onchange: (value) => send(withShifted(now.tables, now.pins, members, [0, 0, value - height(first)])),
      }).element,
    ];
  }

  /** What holds for all places of a table. */
  function whole(now, number, table) {
    const change = (patch) => send(withTable(now.tables, number, patch));
    const offset = table.offset_mm ?? [0, 0, 0];
    const parts = [section("All places of this support")];
    const shown = now.pins[number];
    if (canSplit(table, shown))
      parts.push(
        button({
          text: "Split into single needles",
          kind: "wide",
          testid: "split-support",
          onclick: () => (send(split(now.tables, now.pins, number)), store.set({ support: { table: number, point: 0 } })),
        }),
      );
    if (isPoints(table) && table.points_mm.length > 1)
      parts.push(
        button({
          text: "Choose all of them",
          kind: "wide",
          testid: "choose-needles",
          onclick: () => {
            const [first, ...also] = table.points_mm.map((_, point) => ({ table: number, point }));
            store.set({ support: { ...first, also } });
          },
        }),
      );
    if (isPoints(table) && table.target_mm && pointsOf(table, sheet().pins[number]).length > 1) {
      parts.push(
        numberField({
          label: "Spread on the board",
          unit: "",
          value: spreadOf(table),
          min: 0.001,
          max: 10,
          step: 0.01,
          digits: 3,
          testid: "support-spread",
          field: "pins.target_mm",
          onchange: (value) => send(withSpread(now.tables, number, value)),
        }).element,
        hint("Distances on the board over those on the print. Less: the sheet rises more."),
      );
    } else if (!table.target_mm) {
      parts.push(
        numberField({
          label: "Spread on the board",
          unit: "",
          value: table.scale ?? 1,
          min: 0.001,
          max: 10,
          step: 0.01,
          testid: "support-scale",
          field: "pins.scale",
          onchange: (value) => change({ scale: value }),
        }).element,
        numberField({
          label: "Height",
          value: offset[2],
          min: -5000,
          max: 5000,
          step: 0.5,
          testid: "support-height",
          field: "pins.offset_mm",
          onchange: (value) => change({ offset_mm: [offset[0], offset[1], value] }),
        }).element,
      );
    }
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
    parts.push(labelled("Sliding", slide), later.element);
    return parts;
  }

  on(["sheet", "support"], update);
  update();
  return [body];
}
