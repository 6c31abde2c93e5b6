// The export dialog: files for the printer, and what was written.

import { addressOf, button, check, choice, dialog, h, hint, labelled, replace, section, show } from "../dom.js";
import { bytes, capital } from "../format.js";
import { icon } from "../icons.js";
import { numberField } from "./fields.js";

export function openExport({ store, actions }) {
  const { printers = [], plastics = [] } = store.get("document");
  const chosen = {
    printer: store.get("sheet").printer?.name ?? printers[0]?.name,
    plastic: (plastics.find(({ name }) => name.startsWith("tpu")) ?? plastics[0])?.name,
    preview: true,
    border: true,
    needle_spacing_mm: 20,
  };
  /** Value and change of a control that is about one of the choices. */
  const about = (key) => ({ value: chosen[key], onchange: (value) => (chosen[key] = value) });
  const list = (label, key, profiles) => {
    const options = profiles.map(({ name, title }) => ({ value: name, text: title ?? name }));
    return labelled(label, choice({ label, testid: `export-${key}`, options, ...about(key) }));
  };
  const progress = () => store.get("jobs").export;
  const go = button({
    icon: "export",
    text: "Write the files",
    kind: "primary",
    testid: "export-go",
    disabled: () => Boolean(progress()),
    onclick: () => actions.writeFiles(chosen),
  });
  const waiting = h("div.row", { hidden: () => !progress() }, [
    h("span.grow", "Writing the files …"),
    button({ text: "Cancel", testid: "export-cancel", onclick: actions.cancel }),
  ]);
  const written = h("div", { role: "status", testid: "export-result" });
  function writtenPart({ files, summary, warnings = [] }) {
    const others = files.filter((file) => !first(files).includes(file));
    return [
      section("Written"),
      hint(`All files are in ${folderOf(store.get("document").path, files)}`),
      summary?.shape_state ? hint(`The shape: ${summary.shape_state}`) : null,
      warnings.map((text) => hint(capital(text))),
      fileList(first(files)),
      h("details", { testid: "export-more" }, h("summary", "Files for other programs"), fileList(others)),
    ];
  }
  const update = () => {
    const { export: result } = store.get("results");
    show(go, waiting, shape);
    replace(written, !progress() && result?.files ? writtenPart(result) : null);
  };
  const shape = check({
    text: () => `Write the shape too: ${store.get("badge").words}`,
    testid: "export-preview",
    ...about("preview"),
  });
  dialog(
    "Export for the printer",
    h("div.export", [
      list("Printer", "printer", printers),
      plastics.length > 0 && list("Plastic", "plastic", plastics),
      hint(
        "Solids for the slicer, layouts at 1:1, drilling template, start code, instructions, and the rounded design.",
      ),
      shape,
      check({ text: "Print a line to cut along", testid: "export-border", ...about("border") }),
      numberField({
        label: "Needles on supported edges, at most apart",
        min: 2,
        max: 200,
        testid: "export-spacing",
        ...about("needle_spacing_mm"),
      }),
      h("div.row", go),
      waiting,
      written,
    ]),
    { testid: "export-dialog", onclose: store.on(["results", "jobs", "badge"], update) },
  );
  update();
}

// what most people need, in the order in which they need it, and what each is for
const USES = {
  "instructions.pdf": "Read first: from stretching the fabric to pinning",
  "print.3mf": "For the slicer",
  "start.gcode": "For the slicer: start code, for a nozzle that begins on the fabric",
  "layout.pdf": "Layout, stretch check and drilling template, at 1:1",
  "shape.obj": "The sheet in space, for Rhino and others",
};
const nameOf = (file) => file.name.split("/").at(-1);
const first = (files) => Object.keys(USES).flatMap((name) => files.filter((file) => nameOf(file) === name));

/** The folder on this machine into which files were written. */
function folderOf(design, files) {
  const slash = design.includes("\\") ? "\\" : "/";
  const below = files[0]?.name.split("/").slice(-2, -1) ?? [];
  return [...design.split(slash).slice(0, -1), ...below].join(slash);
}

function fileList(files) {
  const item = ({ name, size }) => {
    const own = nameOf({ name });
    const about = own in USES ? h("div.muted", USES[own]) : null;
    return h("li", [
      h("a.item", { href: addressOf(name), download: own, title: "Download" }, [
        icon("export"),
        h("span.grow", own, about),
        h("span.count", bytes(size)),
      ]),
    ]);
  };
  return h("ul.list.files", files.map(item));
}
