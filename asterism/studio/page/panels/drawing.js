// The dialog that lays a drawing on the sheet: each layer becomes rods, the outline, both, or is left out.

import { button, check, choice, colourOf, dialog, h, hint, labelled, segments, show, table } from "../dom.js";
import { fixed, plural, size } from "../format.js";
import { numberField } from "./fields.js";
import { smallPlan } from "./small_plan.js";
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
    options: units.map((value) => ({ value, text: UNIT_NAMES[value] ?? value })),
    value: unit,
    onchange: (value) => (unit = value),
  });
  const go = () => (element.close(), answer(unit));
  const element = dialog(
    `Unit of ${name}`,
    h("div.export", [
      hint("The file does not say in which unit it is drawn."),
      labelled("One unit of the drawing is", chosen),
      h("div.row", button({ text: "Go on", kind: "primary", testid: "drawing-unit-go", onclick: go })),
    ]),
    { testid: "unit-dialog" },
  );
}

/** `drawing`: the answer of the server to an upload. */
export function openDrawing({ store, edits, actions }, drawing) {
  const { design, box, limits } = store.get("sheet");
  const pattern = design.rods ?? design.stars ?? {};
  const presentOf = (key, otherwise) => (typeof pattern[key] === "number" ? pattern[key] : otherwise);
  const layers = drawing.layers.map((layer) => ({
    ...layer,
    use: layer.has_rings && OUTLINE_NAMES.test(layer.name) ? "outline" : "rods",
    thickness: presentOf("thickness_mm", 0.3),
    width: layer.widths_mm?.[0] >= MIN_STROKE_MM ? layer.widths_mm[1] : presentOf("width_mm", 1.2),
  }));
  const of = (...uses) => layers.filter(({ use }) => uses.includes(use));
  const hasRods = () => of("rods", "both").length > 0;
  const hasStrokes = () => hasRods() && of("rods", "both").every(({ widths_mm: widths }) => widths);
  const fits = drawing.size_mm.every((extent, axis) => extent <= box.size[axis]);
  const chosen = {
    strokes: hasStrokes() && of("rods", "both").every(({ widths_mm: widths }) => widths[0] >= MIN_STROKE_MM),
    keep: false,
    sheet: fits ? "kept" : "around",
    origin: "middle",
  };
  /** Value and change of a control that is about one of the choices. */
  const about = (key) => ({ value: chosen[key], onchange: (value) => ((chosen[key] = value), update()) });

  const picture = h("canvas.drawing-picture", { width: 560, height: 360, role: "img", testid: "drawing-picture" });
  picture.setAttribute("aria-label", `The drawing, ${size(drawing.size_mm)}`);

  function row(layer) {
    const isOfRods = () => ["rods", "both"].includes(layer.use);
    const isAsDrawn = () => chosen.strokes && hasStrokes();
    const cell = (key, label, step, hidden) =>
      numberField({
        label: `${label} of ${layer.name}`,
        value: layer[key],
        min: limits.design[`${key}_mm`][0],
        max: limits.design[`${key}_mm`][1],
        step,
        digits: 2,
        testid: `drawing-${key}-${layer.name}`,
        hidden,
        onchange: (value) => (layer[key] = value),
      });
    const use = choice({
      label: `Use of ${layer.name}`,
      testid: `drawing-use-${layer.name}`,
      options: {
        rods: "Rods",
        outline: { text: "Outline and holes", disabled: !layer.has_rings },
        both: { text: "Rods and outline", disabled: !layer.is_one_ring },
        none: "Left out",
      },
      value: () => layer.use,
      onchange: (value) => {
        layer.use = value;
        // one line is the outline
        if (value === "both" || value === "outline")
          for (const other of of("both")) if (other !== layer) other.use = "rods";
        update();
      },
    });
    const said = `${plural(layer.count, "line")}${layer.widths_mm ? `, ${widthText(layer.widths_mm)}` : ""}`;
    return h("tr", { className: () => (layer.use === "none" ? "off" : "") }, [
      h("th", { scope: "row" }, h("span", { title: layer.name }, layer.name), h("span.muted", said)),
      h("td", use),
      h("td", cell("thickness", "Thickness", 0.05, () => !isOfRods())),
      h("td", [
        cell("width", "Width", 0.1, () => !isOfRods() || isAsDrawn()),
        h("span.muted", { hidden: () => !isOfRods() || !isAsDrawn() }, "As drawn"),
      ]),
    ]);
  }
  const sheets = {
    kept: "As it is",
    around: { text: "Rectangle around it", title: "A rectangle with 10 mm around the drawing" },
  };
  const places = {
    middle: "In the middle",
    drawing: { text: "As drawn", title: "At the drawing's own coordinates" },
  };
  const isOutlined = () => !hasRods() || of("outline", "both").length > 0;
  const fault = h("div.fault.any", { role: "alert", hidden: true, testid: "drawing-problem" });
  let isSent = false;
  const go = button({
    icon: "upload",
    text: "Put it on the sheet",
    kind: "primary",
    testid: "drawing-go",
    disabled: () => isSent || (!hasRods() && !of("outline").length),
    onclick: place,
  });

  function place() {
    const before = store.get("document").revision;
    const used = layers.filter(({ use }) => use !== "none");
    isSent = true;
    update();
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
      isSent = false;
      show(go);
      if (document.revision === before) return; // refused; the line says why
      element.close();
      actions.fitSoon(before);
      toast(`${drawing.name} is on the sheet${drawing.left_out ? `; left out: ${drawing.left_out}` : ""}.`, {
        action: { text: "Undo", run: actions.undo },
      });
    });
  }
  let stop = () => {};

  const body = h("div.drawing", [
    h("div", [
      picture,
      hint(`${size(drawing.size_mm, 1)}, ${plural(layers.length, "layer")}`, { testid: "drawing-size" }),
      drawing.left_out ? hint(`Left out: ${drawing.left_out}.`) : null,
      titled("Outline of the sheet", "Sheet", { testid: "drawing-sheet", options: sheets, ...about("sheet") }, isOutlined),
      titled("Place on the sheet", "Place", { testid: "drawing-origin", options: places, ...about("origin") }),
      check({ text: "Widths as drawn", testid: "drawing-strokes", ...about("strokes"), hidden: () => !hasStrokes() }),
      check({
        text: "Keep the pattern that is on the sheet",
        testid: "drawing-keep",
        ...about("keep"),
        hidden: () => !hasRods(),
      }),
    ]),
    h("div.layers-list", table({ className: "small layers" }, HEADS, layers.map(row))),
    h("div.end", fault, go),
  ]);
  const element = dialog(`Put ${drawing.name} on the sheet`, body, { testid: "drawing-dialog", onclose: () => stop() });
  function update() {
    fault.hidden = true;
    show(body);
    drawPicture(picture, layers);
  }
  drawPicture(picture, layers);
}

/** Some values beside each other under their name. */
const titled = (text, label, options, hidden) =>
  h("div.labelled", { hidden }, h("span.muted", text), segments({ label, ...options }));

/** Rods dark, the outline in the accent colour, what is left out faint. */
function drawPicture(canvas, layers) {
  const { context, path } = smallPlan(canvas, layers.flatMap(({ lines }) => lines.flat()), 24);
  context.lineCap = context.lineJoin = "round";
  const order = ["none", "rods", "both", "outline"];
  for (const { lines, use } of [...layers].sort((a, b) => order.indexOf(a.use) - order.indexOf(b.use))) {
    context.strokeStyle = colourOf({ none: "ink-soft", rods: "ink" }[use] ?? "accent");
    context.lineWidth = { none: 1, outline: 3 }[use] ?? 5;
    for (const line of lines) {
      path(line);
      context.stroke();
    }
  }
}

const widthText = ([low, high]) =>
  high - low < 0.01 ? `${fixed(low, 2)} mm wide` : `${fixed(low, 2)} to ${fixed(high, 2)} mm wide`;
