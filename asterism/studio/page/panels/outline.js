// Panel of the outline: regular shapes, corners as numbers, drawing files.

import { button, h, hint, section, segments } from "../dom.js";
import { fixed, mistakeOf, numberOf } from "../format.js";
import { regularShape } from "../plan/tools/outline.js";
import { numberField } from "./fields.js";
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
    options: [
      { value: "rectangle", text: "Rectangle" },
      { value: "hexagon", text: "Hexagon" },
      { value: "polygon", text: "Polygon" },
      { value: "circle", text: "Circle" },
    ],
    value: shape.kind,
    onchange: (value) => ((shape.kind = value), show()),
  });
  function show() {
    width.element.hidden = shape.kind === "hexagon";
    width.element.querySelector("label").textContent = shape.kind === "rectangle" ? "Width" : "Diameter";
    height.element.hidden = shape.kind !== "rectangle";
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
      const sized = { ...shape, sides: shape.kind === "circle" ? 48 : shape.sides };
      tool.setBorder(regularShape(shape.kind, sized));
      actions.fitSoon();
    },
  });
  const upload = button({
    icon: "upload",
    text: "SVG, DXF or CSV…",
    kind: "wide",
    testid: "upload-outline",
    onclick: () => actions.upload("outline", ".svg,.dxf,.csv"),
  });
  const title = section("Corners", h("span", { class: "count" }));
  const list = h("div", { class: "corners" });
  function corners() {
    const { outline } = store.get("sheet") ?? { outline: [] };
    title.lastChild.textContent = String(outline.length);
    rebuild(list, () =>
      outline.length <= MAX_LISTED
        ? outline.map((_, k) => row(outline, k))
        : [hint("Select a corner in the plan; its place appears here."), chosenRow(outline)],
    );
  }
  function chosenRow(outline) {
    const k = store.get("corner");
    return k !== null && outline[k] ? [row(outline, k)] : [];
  }
  function row(outline, k) {
    const move = (axis, value) =>
      tool.setCorners(
        outline.map((corner, other) => (other === k ? corner.map((old, a) => (a === axis ? value : old)) : corner)),
      );
    const cell = (axis) => {
      const input = h("input", {
        class: "text cell",
        value: fixed(outline[k][axis], 2).replace("−", "-"),
        "aria-label": `Corner ${k}, ${"xy"[axis]} in mm`,
        testid: `corner-${k}-${"xy"[axis]}`,
      });
      input.addEventListener("keydown", (event) => event.stopPropagation());
      input.addEventListener("focus", () => store.set({ corner: k }));
      input.addEventListener("change", () => {
        const refused = mistakeOf(input.value, { unit: "mm" });
        input.classList.toggle("bad-field", Boolean(refused));
        input.title = refused ?? "";
        if (!refused) move(axis, numberOf(input.value, "mm"));
      });
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
  on(["sheet"], corners);
  on(["corner"], () => (store.get("sheet")?.outline.length ?? 0) > MAX_LISTED && corners());
  corners();
  return [
    section("Regular shape"),
    kind.element,
    width.element,
    height.element,
    sides.element,
    rings.element,
    apply,
    section("From a drawing"),
    upload,
    title,
    list,
  ];
}
