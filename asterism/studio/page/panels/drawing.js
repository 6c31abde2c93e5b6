// The dialog that lays a drawing on the sheet: each layer becomes rods, the outline, both, or is left out.

import { button, check, choice, dialog, h, hint, labelled, segments, table } from "../dom.js";
import { fixed, plural, size } from "../format.js";
import { pictureOf } from "./drawing_picture.js";
import { numberField } from "./fields.js";
import { toast } from "./toasts.js";

const OUTLINE_NAMES = /outline|border|contour|boundary|sheet|cut\b|umriss|rand\b/i;
const MIN_STROKE_MM = 0.3; // thinner strokes are hairlines: they say where, not how wide
const HEADS = ["Layer", "Becomes", "Thickness", "Width"];
const UNIT_NAMES = { mm: "Millimetres", cm: "Centimetres", in: "Inches", px: "Pixels, 96 to the inch" };

/** Asks for the unit of a file that has none. */
export function askUnit(name, units, answer) {
  let unit = units[0];
  const chosen = choice({
    label: "Unit of the drawing",
    testid: "drawing-unit",
    options: Object.fromEntries(units.map((value) => [value, UNIT_NAMES[value] ?? value])),
    value: unit,
    onchange: (value) => (unit = value),
  });
  const element = dialog(
    `Unit of ${name}`,
    h(
      "div",
      { class: "export" },
      hint("The file does not say in which unit it is drawn."),
      labelled("One unit of the drawing is", chosen),
      h(
        "div",
        { class: "row" },
        button({ text: "Go on", kind: "primary", testid: "drawing-unit-go", onclick: () => (element.close(), answer(unit)) }),
      ),
    ),
    { testid: "unit-dialog" },
  );
}

/** `drawing`: the answer of the server to an upload. */
export function openDrawing({ store, edits, actions }, drawing) {
  const { design, box } = store.get("sheet");
  const limits = store.get("sheet").limits.design;
  const pattern = design.rods ?? design.stars ?? {};
  const presentOf = (key, otherwise) => (typeof pattern[key] === "number" ? pattern[key] : otherwise);
  const layers = drawing.layers.map((layer) => ({
    ...layer,
    use: layer.has_rings && OUTLINE_NAMES.test(layer.name) ? "outline" : "rods",
    thickness: presentOf("thickness_mm", 0.3),
    width: layer.widths_mm?.[0] >= MIN_STROKE_MM ? layer.widths_mm[1] : presentOf("width_mm", 1.2),
  }));
  const fits = drawing.size_mm.every((extent, axis) => extent <= box.size[axis]);
  const chosen = { strokes: false, keep: false, sheet: fits ? "kept" : "around", origin: "middle" };
  const of = (...uses) => layers.filter(({ use }) => uses.includes(use));
  const hasStrokes = () => of("rods", "both").length > 0 && of("rods", "both").every(({ widths_mm: widths }) => widths);
  chosen.strokes = hasStrokes() && of("rods", "both").every(({ widths_mm: widths }) => widths[0] >= MIN_STROKE_MM);

  const picture = h("canvas", { width: 560, height: 360, class: "drawing-picture", role: "img", testid: "drawing-picture" });
  picture.setAttribute("aria-label", `The drawing, ${size(drawing.size_mm)}`);
  const cell = (layer, key, label) =>
    numberField({
      label: `${label} of ${layer.name}`,
      value: layer[key],
      min: limits[`${key}_mm`][0],
      max: limits[`${key}_mm`][1],
      step: key === "width" ? 0.1 : 0.05,
      digits: 2,
      testid: `drawing-${key}-${layer.name}`,
      onchange: (value) => (layer[key] = value),
    });
  const rows = layers.map((layer) => {
    const uses = {
      rods: "Rods",
      outline: { text: "Outline and holes", disabled: !layer.has_rings },
      both: { text: "Rods and outline", disabled: !layer.is_one_ring },
      none: "Left out",
    };
    const use = choice({
      label: `Use of ${layer.name}`,
      testid: `drawing-use-${layer.name}`,
      options: uses,
      value: layer.use,
      onchange: (value) => {
        layer.use = value;
        for (const other of layers) // one line is the outline
          if (other !== layer && (value === "both" || value === "outline") && other.use === "both") {
            other.use = "rods";
            rows[layers.indexOf(other)].use.set("rods");
          }
        show();
      },
    });
    const [thickness, width] = [cell(layer, "thickness", "Thickness"), cell(layer, "width", "Width")];
    const drawn = h("span", { class: "muted" }, "As drawn");
    const about = `${plural(layer.count, "line")}${layer.widths_mm ? `, ${widthText(layer.widths_mm)}` : ""}`;
    const element = h(
      "tr",
      {},
      h("th", { scope: "row" }, h("span", { title: layer.name }, layer.name), h("span", { class: "muted" }, about)),
      h("td", {}, use.element),
      h("td", {}, thickness.element),
      h("td", {}, width.element, drawn),
    );
    return { element, use, thickness, width, drawn };
  });
  const strokes = check({
    text: "Widths as drawn",
    value: chosen.strokes,
    testid: "drawing-strokes",
    onchange: (on) => ((chosen.strokes = on), show()),
  });
  const keep = check({
    text: "Keep the pattern that is on the sheet",
    value: chosen.keep,
    testid: "drawing-keep",
    onchange: (on) => (chosen.keep = on),
  });
  const sheet = segments({
    label: "Sheet",
    testid: "drawing-sheet",
    options: {
      kept: "As it is",
      around: { text: "Rectangle around it", title: "A rectangle with 10 mm around the drawing" },
    },
    value: chosen.sheet,
    onchange: (value) => (chosen.sheet = value),
  });
  const origin = segments({
    label: "Place",
    testid: "drawing-origin",
    options: { middle: "In the middle", drawing: { text: "As drawn", title: "At the drawing's own coordinates" } },
    value: chosen.origin,
    onchange: (value) => (chosen.origin = value),
  });
  const sheetRow = titled("Outline of the sheet", sheet);
  const fault = h("div", { class: "fault any", role: "alert", hidden: true, testid: "drawing-problem" });
  const go = button({ icon: "upload", text: "Put it on the sheet", kind: "primary", testid: "drawing-go", onclick: place });

  function show() {
    const hasRods = of("rods", "both").length > 0;
    rows.forEach(({ element, thickness, width, drawn }, k) => {
      const isOfRods = ["rods", "both"].includes(layers[k].use);
      element.classList.toggle("off", layers[k].use === "none");
      thickness.element.hidden = !isOfRods;
      const isAsDrawn = strokes.box.checked && hasStrokes();
      width.element.hidden = !isOfRods || isAsDrawn;
      drawn.hidden = !isOfRods || !isAsDrawn;
    });
    strokes.element.hidden = !hasStrokes();
    keep.element.hidden = !hasRods;
    sheetRow.hidden = !hasRods || of("outline", "both").length > 0;
    go.disabled = !hasRods && !of("outline").length;
    fault.hidden = true;
    pictureOf(picture, layers, drawing.size_mm);
  }

  function place() {
    const before = store.get("document").revision;
    const used = layers.filter(({ use }) => use !== "none");
    fault.hidden = true;
    go.disabled = true;
    edits.once(() =>
      edits.drawing({
        drawing: drawing.number,
        layers: Object.fromEntries(used.map(({ name, use, thickness, width }) => [name, { use, thickness, width }])),
        ...chosen,
        strokes: chosen.strokes && hasStrokes(),
      }),
    );
    stop = store.on(["document"], ({ document }) => {
      if (edits.isWaiting) return;
      stop();
      go.disabled = false;
      if (document.revision === before) return; // refused; the line says why
      element.close();
      actions.fitSoon(before);
      const leftOut = drawing.left_out ? `; left out: ${drawing.left_out}` : "";
      toast(`${drawing.name} is on the sheet${leftOut}.`, { action: { text: "Undo", run: actions.undo } });
    });
  }
  let stop = () => {};

  const body = h(
    "div",
    { class: "drawing" },
    h(
      "div",
      {},
      picture,
      h("p", { class: "hint", testid: "drawing-size" }, `${size(drawing.size_mm, 1)}, ${plural(layers.length, "layer")}`),
      drawing.left_out ? hint(`Left out: ${drawing.left_out}.`) : null,
      sheetRow,
      titled("Place on the sheet", origin),
      strokes.element,
      keep.element,
    ),
    h("div", { class: "layers-list" }, table({ class: "small layers" }, HEADS, rows.map((row) => row.element))),
    h("div", { class: "end" }, fault, go),
  );
  const element = dialog(`Put ${drawing.name} on the sheet`, body, { testid: "drawing-dialog", onclose: () => stop() });
  show();
}

const titled = (text, { element }) => h("div", { class: "labelled" }, h("span", { class: "muted" }, text), element);

const widthText = ([low, high]) =>
  high - low < 0.01 ? `${fixed(low, 2)} mm wide` : `${fixed(low, 2)} to ${fixed(high, 2)} mm wide`;
