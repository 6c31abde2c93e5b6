// Panel of the outline: regular shapes, corners, circles and holes as numbers, drawing files.

import { curvesOf } from "../border.js";
import { button, counted, h, hint, listItem, refresh, section, segments } from "../dom.js";
import { fixed, plural } from "../format.js";
import { regularShape, sizeOf } from "../plan/tools/outline.js";
import { numberCell, numberField } from "./fields.js";
import { rebuild } from "../rebuild.js";

const MAX_LISTED = 16; // corners

export function outlinePanel({ store, edits, tools, actions }, { on }) {
  const tool = tools.outline.tool;
  const shape = { kind: "rectangle", width: 160, height: 120, sides: 8, rings: 3 };
  const box = store.get("sheet")?.box.size;
  if (box) Object.assign(shape, { width: Math.round(box[0]), height: Math.round(box[1]) });
  const field = (label, key, rest) =>
    numberField({
      label,
      value: shape[key],
      min: 1,
      max: 5000,
      onchange: (value) => (shape[key] = value),
      testid: `shape-${key}`,
      ...rest,
    });
  const width = field("Width", "width", { field: "border.rectangle_mm" });
  const height = field("Height", "height");
  const sides = field("Corners", "sides", { unit: "", min: 3, max: 120, whole: true });
  const rings = field("Rings of stars", "rings", { unit: "", min: 0, max: 40, whole: true, field: "border.rings" });
  const kind = segments({
    label: "Regular shape",
    testid: "shape",
    options: { rectangle: "Rectangle", hexagon: "Hexagon", polygon: "Polygon", circle: "Circle", l: "L" },
    value: shape.kind,
    onchange: (value) => ((shape.kind = value), show()),
  });
  function show() {
    width.element.hidden = shape.kind === "hexagon";
    width.element.querySelector("label").textContent = shape.kind === "polygon" ? "Diameter" : "Width";
    height.element.hidden = !["rectangle", "circle", "l"].includes(shape.kind);
    sides.element.hidden = shape.kind !== "polygon";
    rings.element.hidden = shape.kind !== "hexagon";
  }
  show();
  const apply = button({
    text: "Use this shape",
    kind: "wide",
    testid: "use-shape",
    onclick: () => {
      const shown = [width, height, sides, rings].filter((one) => !one.element.hidden);
      if (shown.some((one) => one.isRefused())) return;
      tool.setBorder(regularShape(shape.kind, shape));
      actions.fitSoon();
    },
  });
  const upload = button({
    icon: "upload",
    text: "From SVG, DXF or CSV…",
    kind: "wide",
    testid: "upload-outline",
    onclick: () => actions.upload("outline", ".svg,.dxf,.csv"),
  });
  const list = h("div", { class: "corners" });
  const holes = h("div", {});
  const said = h("div", {});
  function update() {
    const sheet = store.get("sheet");
    if (!sheet) return;
    const outline = tool.corners();
    const round = curvesOf(sheet).find(({ hole }) => hole === null);
    rebuild(list, () => {
      if (round) return [section(round.axes[0] === round.axes[1] ? "Circle" : "Ellipse"), ...numbers(round, "outline")];
      const title = counted("Corners", outline.length);
      if (outline.length <= MAX_LISTED) return [title, outline.map((_, k) => row(outline, k))];
      return [title, hint("Select a corner in the plan; its place appears here."), chosenRow(outline)];
    });
    rebuild(holes, () => holesPart(curvesOf(sheet).filter(({ hole }) => hole !== null)));
    const cut = sheet.stars.filter((star) => star.isCut).map((star) => star.key);
    refresh(said, cut, () =>
      cut.length
        ? [
            hint(`${plural(cut.length, "star")} with arms that an edge cuts.`),
            button({ text: "Select them", testid: "select-cut", onclick: () => store.set({ selection: new Set(cut) }) }),
          ]
        : [],
    );
  }
  /** Place and size of a circle, an ellipse, or the place of another hole. */
  function numbers(curve, name) {
    const { centre, axes } = curve;
    const one = (text, key, value, min, change) =>
      numberField({
        label: text,
        value,
        min,
        max: 5000,
        step: 0.5,
        digits: 2,
        testid: `${name}-${key}`,
        onchange: (typed) => tool.setCurve(curve, change(typed)) || update(),
      }).element;
    const placed = (text, axis) =>
      one(text, "xy"[axis], centre[axis], -5000, (value) => ({ centre: centre.with(axis, value) }));
    const sized = (text, axis) =>
      one(text, text.toLowerCase(), 2 * axes[axis], 2, (value) => ({ axes: axes.with(axis, value / 2) }));
    return [placed("Centre x", 0), placed("Centre y", 1), axes && [sized("Width", 0), sized("Height", 1)]];
  }
  function holesPart(curves) {
    const chosen = tool.chosenHole();
    return [
      counted(
        "Holes",
        curves.length,
        chosen &&
          button({
            icon: "trash",
            label: "Remove this hole",
            keys: "Delete",
            kind: "plain danger",
            testid: "remove-hole",
            onclick: () => tool.removeHole(),
          }),
      ),
      h("ul", { class: "list" }, curves.map((curve) => item(curve, curve.hole === chosen?.hole))),
      chosen ? numbers(chosen, "hole") : null,
      button({ text: "Cut a round hole", kind: "wide", testid: "add-hole", onclick: () => tool.addHole() }),
    ];
  }
  const item = (curve, isCurrent) =>
    listItem({
      icon: "outline",
      text: `Hole ${curve.number}`,
      count: sizeOf(curve),
      isCurrent,
      testid: `hole-${curve.hole}`,
      onclick: () => store.set({ hole: curve.hole, corner: null }),
    });
  function chosenRow(outline) {
    const k = store.get("corner");
    return k !== null && outline[k] ? [row(outline, k)] : [];
  }
  function row(outline, k) {
    const move = (axis, value) => tool.setCorners(outline.with(k, outline[k].with(axis, value)));
    const cell = (axis) => {
      const input = numberCell({
        value: fixed(outline[k][axis], 2).replace("−", "-"),
        label: `Corner ${k}, ${"xy"[axis]} in mm`,
        testid: `corner-${k}-${"xy"[axis]}`,
        onchange: (value) => move(axis, value),
      });
      input.addEventListener("focus", () => store.set({ corner: k, hole: null }));
      return input;
    };
    return h(
      "div",
      { class: "row tight" },
      h("span", { class: "number-tag" }, k),
      cell(0),
      cell(1),
      h("span", { class: "unit-tag" }, "mm"),
      button({
        icon: "trash",
        label: `Remove corner ${k}`,
        testid: `remove-corner-${k}`,
        kind: "plain danger",
        disabled: outline.length <= 3,
        onclick: () => (store.set({ corner: k }), tool.removeCorner()),
      }),
    );
  }
  on(["sheet", "hole"], update);
  on(["corner"], () => (store.get("sheet")?.outline.length ?? 0) > MAX_LISTED && update());
  update();
  return [
    section("Regular shape"),
    kind.element,
    width.element,
    height.element,
    sides.element,
    rings.element,
    apply,
    upload,
    holes,
    said,
    list,
  ];
}
