// Panel of the outline: regular shapes, corners, circles and holes as numbers, drawing files.

import { curvesOf } from "../border.js";
import { button, counted, follow, h, hint, listItem, part, section, segments, show, wide } from "../dom.js";
import { fixed, plural } from "../format.js";
import { regularShape, sizeOf } from "../plan/tools/outline.js";
import { numberCell, numberField, rebuild } from "./fields.js";

const MAX_LISTED = 16; // corners

export function outlinePanel({ store, tools, actions }, { on }) {
  const tool = tools.outline.tool;
  const [width, height] = store.get("sheet")?.box.size ?? [160, 120];
  const shape = { kind: "rectangle", width: Math.round(width), height: Math.round(height), sides: 8, rings: 3 };
  const field = (label, key, kinds, rest = {}) =>
    numberField({
      label,
      value: () => shape[key],
      min: 1,
      max: 5000,
      hidden: () => !kinds.includes(shape.kind),
      onchange: (value) => (shape[key] = value),
      testid: `shape-${key}`,
      ...rest,
    });
  const counts = { unit: "", whole: true };
  const widthText = () => (shape.kind === "polygon" ? "Diameter" : "Width");
  const sizes = [
    field(widthText, "width", ["rectangle", "polygon", "circle", "l"], { field: "border.rectangle_mm" }),
    field("Height", "height", ["rectangle", "circle", "l"]),
    field("Corners", "sides", ["polygon"], { ...counts, min: 3, max: 120 }),
    field("Rings of stars", "rings", ["hexagon"], { ...counts, min: 0, max: 40, field: "border.rings" }),
  ];
  const kind = segments({
    label: "Regular shape",
    testid: "shape",
    options: { rectangle: "Rectangle", hexagon: "Hexagon", polygon: "Polygon", circle: "Circle", l: "L" },
    value: shape.kind,
    onchange: (value) => ((shape.kind = value), show(sizes)),
  });
  function use() {
    if (sizes.some((one) => !one.element.hidden && one.isRefused())) return;
    tool.setBorder(regularShape(shape.kind, shape));
    actions.fitSoon();
  }
  const trash = (label, testid, onclick, rest = {}) =>
    button({ icon: "trash", label, kind: "plain danger", testid, onclick, ...rest });

  const list = h("div.corners");
  const holes = h("div");
  function update() {
    const sheet = store.get("sheet");
    if (!sheet) return;
    const outline = tool.corners();
    const round = curvesOf(sheet).find(({ hole }) => hole === null);
    rebuild(list, () => {
      if (round) return [section(round.axes[0] === round.axes[1] ? "Circle" : "Ellipse"), ...numbers(round, "outline")];
      const title = counted("Corners", outline.length);
      if (outline.length <= MAX_LISTED) return [title, outline.map((_, k) => row(outline, k))];
      const k = store.get("corner");
      const chosen = k !== null && outline[k] ? row(outline, k) : null;
      return [title, hint("Select a corner in the plan; its place appears here."), chosen];
    });
    rebuild(holes, () => holesPart(curvesOf(sheet).filter(({ hole }) => hole !== null)));
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
      });
    const placed = (text, axis) =>
      one(text, "xy"[axis], centre[axis], -5000, (value) => ({ centre: centre.with(axis, value) }));
    const sized = (text, axis) =>
      one(text, text.toLowerCase(), 2 * axes[axis], 2, (value) => ({ axes: axes.with(axis, value / 2) }));
    return [placed("Centre x", 0), placed("Centre y", 1), axes && [sized("Width", 0), sized("Height", 1)]];
  }
  function holesPart(curves) {
    const chosen = tool.chosenHole();
    const remove = () => trash("Remove this hole", "remove-hole", () => tool.removeHole(), { keys: "Delete" });
    return [
      counted("Holes", curves.length, chosen && remove()),
      h("ul.list", curves.map((curve) => item(curve, curve.hole === chosen?.hole))),
      chosen ? numbers(chosen, "hole") : null,
      wide("Cut a round hole", "add-hole", () => tool.addHole()),
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
  function row(outline, k) {
    const cell = (axis) =>
      numberCell({
        value: fixed(outline[k][axis], 2).replace("−", "-"),
        "aria-label": `Corner ${k}, ${"xy"[axis]} in mm`,
        testid: `corner-${k}-${"xy"[axis]}`,
        onchange: (value) => tool.setCorners(outline.with(k, outline[k].with(axis, value))),
        onfocus: () => store.set({ corner: k, hole: null }),
      });
    const remove = () => (store.set({ corner: k }), tool.removeCorner());
    return h("div.row.tight", [
      h("span.number-tag", String(k)),
      cell(0),
      cell(1),
      h("span.unit-tag", "mm"),
      trash(`Remove corner ${k}`, `remove-corner-${k}`, remove, { disabled: outline.length <= 3 }),
    ]);
  }
  const cut = () => store.get("sheet")?.stars.filter((star) => star.isCut).map((star) => star.key) ?? [];
  const cutPart = part(null, cut, (keys) => {
    if (!keys.length) return [];
    const select = () => store.set({ selection: new Set(keys) });
    return [
      hint(`${plural(keys.length, "star")} with arms that an edge cuts.`),
      button({ text: "Select them", testid: "select-cut", onclick: select }),
    ];
  });
  on(["sheet", "hole"], update);
  on(["corner"], () => (store.get("sheet")?.outline.length ?? 0) > MAX_LISTED && update());
  update();
  return [
    section("Regular shape"),
    kind,
    sizes,
    wide("Use this shape", "use-shape", use),
    wide("From SVG, DXF or CSV…", "upload-outline", () => actions.upload("outline", ".svg,.dxf,.csv"), { icon: "upload" }),
    holes,
    follow(on, ["sheet"], cutPart),
    list,
  ];
}
