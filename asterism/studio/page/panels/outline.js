// Panel of the outline: regular shapes, corners, circles and holes as numbers, drawing files.

import { curvesOf, ofKind } from "../border.js";
import { edgeOf } from "../geometry.js";
import { button, counted, follow, h, hint, listItem, part, section, segments, show, wide } from "../dom.js";
import { plural } from "../format.js";
import { regularOf, regularShape, sizeOf } from "../plan/tools/outline.js";
import { numberCell, numberField, rebuild } from "./fields.js";

const MAX_LISTED = 16; // corners
const KINDS = { circle: "Round", polygon: "Corners", spline: "Smooth" };

export function outlinePanel({ store, edits, tools, actions }, { on }) {
  const tool = tools.outline.tool;
  const shape = { width: 160, height: 120, sides: 8, rings: 3 }; // with its kind, if the outline is a regular one
  const read = () => edits.isWaiting || Object.assign(shape, { kind: null }, regularOf(store.get("sheet")));
  const field = (label, key, kinds, rest = {}) =>
    numberField({
      label,
      value: () => shape[key],
      min: 1,
      max: 5000,
      hidden: () => !kinds.includes(shape.kind),
      onchange: (value) => use({ [key]: value }),
      testid: `shape-${key}`,
      ...rest,
    });
  const counts = { unit: "", whole: true };
  const widthText = () => (shape.kind === "polygon" ? "Diameter" : "Width");
  const sizes = [
    field(widthText, "width", ["rectangle", "polygon", "circle", "l"], { field: "border.rectangle_mm" }),
    field("Height", "height", ["rectangle", "circle", "l"]),
    field("Width of a leg", "leg", ["l"], { limits: () => [1, Math.min(shape.width, shape.height) - 1] }),
    field("Corners", "sides", ["polygon"], { ...counts, min: 3, max: 120 }),
    field("Rings of stars", "rings", ["hexagon"], { ...counts, min: 0, max: 40, field: "border.rings" }),
  ];
  const kind = segments({
    label: "Regular shape",
    testid: "shape",
    options: { rectangle: "Rectangle", hexagon: "Hexagon", polygon: "Polygon", circle: "Circle", l: "L" },
    value: () => shape.kind,
    onchange: (value) => value === shape.kind || use({ kind: value }),
  });
  function use(change) {
    Object.assign(shape, change);
    show(sizes);
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
    read();
    show(kind, sizes);
    const [outline, ...rest] = curvesOf(sheet);
    rebuild(list, () => [section("Outline"), shapeOf(outline, "outline")]);
    rebuild(holes, () => holesPart(rest));
  }
  const change = (curve, what) => tool.setCurve(curve, what) || update();
  /** Kind, place and size of the outline or of a hole, and its corners. */
  function shapeOf(curve, name) {
    const kinds = segments({
      label: "Shape of the edge",
      testid: `${name}-kind`,
      options: KINDS,
      value: curve.kind,
      onchange: (chosen) => chosen !== curve.kind && change(curve, ofKind(curve, chosen)),
    });
    return [kinds, curve.axes || curve.hole !== null ? numbers(curve, name) : null, curve.points ? corners(curve) : null];
  }
  function corners(curve) {
    const { kind, points, hole } = curve;
    const title = counted(kind === "spline" ? "Points" : "Corners", points.length);
    const say = kind === "polygon" ? hint("x, y, and how far the middle of the next edge stands out.") : null;
    if (points.length <= MAX_LISTED) return [title, say, points.map((_, k) => row(curve, k))];
    const k = hole === store.get("hole") ? store.get("corner") : null;
    return [title, hint("Select one in the plan; its place appears here."), points[k] ? row(curve, k) : null];
  }
  /** Place and size of a circle or an ellipse, or the place of another hole. */
  function numbers(curve, name) {
    const { centre, axes, turn } = curve;
    const one = (text, key, value, min, make, rest = {}) =>
      numberField({
        label: text,
        value,
        min,
        max: 5000,
        step: 0.5,
        digits: 2,
        testid: `${name}-${key}`,
        onchange: (typed) => change(curve, make(typed)),
        ...rest,
      });
    const placed = (text, axis) =>
      one(text, "xy"[axis], centre[axis], -5000, (value) => ({ centre: centre.with(axis, value) }));
    const sized = (text, axis) =>
      one(text, text.toLowerCase(), 2 * axes[axis], 2, (value) => ({ axes: axes.with(axis, value / 2) }));
    const turned = { unit: "°", max: 360, step: 5, digits: 1 };
    return [
      placed("Centre x", 0),
      placed("Centre y", 1),
      axes && [sized("Width", 0), sized("Height", 1)],
      axes && axes[0] !== axes[1] && one("Turned", "turn", turn, -360, (value) => ({ turn: value }), turned),
    ];
  }
  function holesPart(curves) {
    const chosen = tool.chosenHole();
    const remove = () => trash("Remove this hole", "remove-hole", () => tool.removeHole(), { keys: "Delete" });
    return [
      counted("Holes", curves.length, chosen && remove()),
      h("ul.list", curves.map((curve) => item(curve, curve.hole === chosen?.hole))),
      chosen ? shapeOf(chosen, "hole") : null,
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
  function row(curve, k) {
    const { hole, kind, points, bulges } = curve;
    const name = hole === null ? `corner-${k}` : `hole-corner-${k}`;
    const cell = (key, what, value, make, rest = {}) =>
      numberCell({
        value: String(Number(value.toFixed(2))),
        "aria-label": `${what} in mm`,
        testid: `${name}-${key}`,
        onchange: (typed) => change(curve, make(typed)),
        onfocus: () => store.set({ corner: k, hole }),
        ...rest,
      });
    const place = (axis) =>
      cell("xy"[axis], `Corner ${k}, ${"xy"[axis]}`, points[k][axis], (value) => ({
        points: points.with(k, points[k].with(axis, value)),
      }));
    const { half } = edgeOf(points, k);
    const stands = `Edge ${k}, how far its middle stands out`;
    const bulge = () =>
      cell("bulge", stands, bulges[k], (value) => ({ bulges: bulges.with(k, value) }), { title: stands, limits: () => [-half, half] });
    const remove = () => (store.set({ corner: k, hole }), tool.removeCorner());
    return h("div.row.tight", [
      h("span.number-tag", String(k)),
      place(0),
      place(1),
      kind === "polygon" ? bulge() : null,
      h("span.unit-tag", "mm"),
      trash(`Remove corner ${k}`, `remove-${name}`, remove, { disabled: points.length <= 3 }),
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
  on(["corner"], () => tool.sheet && (tool.chosen().points?.length ?? 0) > MAX_LISTED && update());
  update();
  return [
    section("Regular shape"),
    kind,
    sizes,
    wide("From SVG, DXF or CSV…", "upload-outline", () => actions.upload("outline", ".svg,.dxf,.csv"), { icon: "upload" }),
    holes,
    follow(on, ["sheet"], cutPart),
    list,
  ];
}
