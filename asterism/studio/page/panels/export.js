// The export dialog: files for the printer, and what was written.

import { button, check, choice, dialog, h, hint, labelled, replace, section } from "../dom.js";
import { bytes, capital } from "../format.js";
import { icon } from "../icons.js";
import { numberField } from "./fields.js";

export function openExport({ store, actions }) {
  const { printers = [], plastics = [] } = store.get("document");
  let printer = store.get("sheet").printer?.name ?? printers[0]?.name;
  let plastic = plastics.find((name) => name.startsWith("tpu")) ?? plastics[0];
  const machine = choice({
    label: "Printer",
    testid: "export-printer",
    options: printers.map(({ name, title }) => ({ value: name, text: title ?? name })),
    value: printer,
    onchange: (value) => (printer = value),
  });
  const material = plastics.length
    ? choice({
        label: "Plastic",
        testid: "export-plastic",
        options: Object.fromEntries(plastics.map((name) => [name, name])),
        value: plastic,
        onchange: (value) => (plastic = value),
      })
    : null;
  const preview = check({
    text: `Write the shape too (OBJ, STL, GLB): ${store.get("badge").words}`,
    value: true,
    testid: "export-preview",
  });
  const border = check({ text: "Print a line to cut along", value: true, testid: "export-border" });
  const spacing = numberField({
    label: "Needles on supported edges, at most apart",
    value: 20,
    min: 2,
    max: 200,
    testid: "export-spacing",
    onchange: (value) => (needleSpacing = value),
  });
  let needleSpacing = 20;
  const said = h("span", { class: "grow" });
  const waiting = h(
    "div",
    { class: "row", hidden: true },
    said,
    button({ text: "Cancel", testid: "export-cancel", onclick: actions.cancel }),
  );
  const written = h("div", { role: "status", testid: "export-result" });
  const go = button({
    icon: "export",
    text: "Write the files",
    kind: "primary",
    testid: "export-go",
    onclick: () => {
      const options = { preview: preview.box.checked, border: border.box.checked, needle_spacing_mm: needleSpacing };
      actions.writeFiles({ printer, plastic, ...options });
    },
  });
  const update = () => {
    const { export: result } = store.get("results");
    const { export: progress } = store.get("jobs");
    go.disabled = Boolean(progress);
    waiting.hidden = !progress;
    if (progress) ((said.textContent = `${progress.stage} …`), replace(written));
    else
      replace(
        written,
        result?.files
          ? [
              section("Written"),
              hint(`All files are in ${folderOf(store.get("document").path, result.files)}`),
              result.summary?.shape_state ? hint(`The shape: ${result.summary.shape_state}`) : null,
              (result.warnings ?? []).map((text) => hint(capital(text))),
              fileList(first(result.files)),
              h(
                "details",
                { testid: "export-more" },
                h("summary", {}, "Files for other programs"),
                fileList(result.files.filter((file) => !first(result.files).includes(file))),
              ),
            ]
          : null,
      );
  };
  const stop = store.on(["results", "jobs"], update);
  dialog(
    "Export for the printer",
    h(
      "div",
      { class: "export" },
      labelled("Printer", machine),
      material && labelled("Plastic", material),
      hint(
        "3MF and STL for the slicer, PDF, SVG and DXF at 1:1, drilling template, start code, instructions, and the rounded design.",
      ),
      preview.element,
      border.element,
      spacing.element,
      h("div", { class: "row" }, go),
      waiting,
      written,
    ),
    { testid: "export-dialog", onclose: stop },
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

const use = (file) => (nameOf(file) in USES ? h("div", { class: "muted" }, USES[nameOf(file)]) : null);

/** The folder on this machine into which files were written. */
function folderOf(design, files) {
  const slash = design.includes("\\") ? "\\" : "/";
  const below = files[0]?.name.split("/").slice(-2, -1) ?? [];
  return [...design.split(slash).slice(0, -1), ...below].join(slash);
}

function fileList(files) {
  return h(
    "ul",
    { class: "list files" },
    files.map((file) =>
      h(
        "li",
        {},
        h(
          "a",
          { class: "item", href: `file/${encodeURI(file.name)}`, download: nameOf(file), title: "Download" },
          icon("export"),
          h("span", { class: "grow" }, nameOf(file), use(file)),
          h("span", { class: "count" }, bytes(file.size)),
        ),
      ),
    ),
  );
}
