// The bar at the top: name, saved mark, undo and redo, open, verify, export, report, theme.

import { button, h } from "../dom.js";
import { icon } from "../icons.js";
import { fitBrushToRods } from "./brush.js";
import { toast } from "./toasts.js";

// by their testids, which are also icons and actions unless these are named
const BUTTONS = {
  undo: { label: "Undo", keys: "Ctrl+Z" },
  redo: { label: "Redo", keys: "Ctrl+Shift+Z" },
  history: { label: "Earlier states", run: "openHistory" },
  open: { text: "Open", keys: "Ctrl+O", run: "openStart" },
  save: { text: "Save", keys: "Ctrl+S" },
  report: { text: "Report" },
  export: { text: "Export", keys: "Ctrl+E", run: "openExport" },
  verify: { text: "Verify", kind: "primary" },
  theme: { icon: "moon", label: "Light or dark", run: "switchTheme" },
};

export function buildTop(element, { store, actions }) {
  const name = h("input", {
    "aria-label": "Name of the design file",
    title: "Name of the design file. Another name saves a copy.",
    testid: "name",
    maxLength: 100,
    spellcheck: false,
  });
  name.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter") name.blur();
  });
  name.addEventListener("change", () => {
    const wanted = name.value.trim();
    name.value = store.get("document").name; // until the file is written: the server may refuse
    if (/[\\/]/.test(wanted)) toast("A name has no slash: the file lies in the folder of the studio.", { isBad: true });
    else if (wanted) actions.saveAs(wanted);
  });
  const saved = h("span", { class: "saved", testid: "saved", role: "status" });
  const buttons = Object.fromEntries(
    Object.entries(BUTTONS).map(([testid, { run = testid, kind = "plain", ...rest }]) => [
      testid,
      button({ icon: testid, testid, kind, onclick: actions[run], ...rest }),
    ]),
  );
  const { undo, redo, history, open, save, report, export: files, verify, theme } = buttons;
  element.append(
    h("span", { class: "brand", title: "asterism studio" }, icon("logo")),
    h("span", { class: "name" }, name),
    saved,
    h("span", { class: "gap" }),
    undo,
    redo,
    history,
    h("span", { class: "rule" }),
    open,
    save,
    h("span", { class: "rule" }),
    report,
    files,
    verify,
    theme,
  );
  function update() {
    const document = store.get("document");
    const isRunning = Object.keys(store.get("jobs")).length > 0; // one job runs at a time
    for (const one of [save, files, history]) one.disabled = !document;
    for (const one of [report, verify]) one.disabled = !document || isRunning;
    undo.disabled = !document?.can_undo;
    redo.disabled = !document?.can_redo;
    name.disabled = !document;
    if (window.document.activeElement !== name) name.value = document?.name ?? "";
    const { unsaved_since: since } = store.get("state");
    const lost = since && !document?.saved ? `Not saved since ${new Date(1000 * since).toTimeString().slice(0, 5)}` : "";
    saved.textContent = !document ? "" : document.saved ? "Saved" : lost || (document.has_file ? "Edited" : "Not saved yet");
    saved.title = document
      ? `${document.path}${document.saved || lost ? "" : "\nUnsaved changes are kept in the autosave."}`
      : "";
    window.document.title = document
      ? `${document.saved ? "" : "• "}${document.name} · asterism studio`
      : "asterism studio";
  }
  store.on(["document", "jobs", "state"], update);
  update();
}

/** The strip of tools on the left. */
export function buildTools(element, { store, tools, actions }) {
  const toolButton = ({ picture, text, title, keys, role, testid, onclick }) =>
    h(
      "button",
      {
        type: "button",
        class: "tool",
        role,
        title: `${title} (${keys})`,
        "aria-label": title,
        "aria-keyshortcuts": keys,
        testid,
        onclick,
      },
      icon(picture),
      h("span", {}, text),
    );
  const buttons = Object.entries(tools).map(([name, { title, keys }]) => {
    const onclick = () => actions.choose(name);
    const one = toolButton({ picture: name, text: title, title, keys, role: "radio", testid: `tool-${name}`, onclick });
    one.dataset.tool = name;
    return one;
  });
  const group = h("div", { role: "radiogroup", "aria-label": "Tool" }, buttons);
  group.style.display = "contents";
  const more = [
    ["table", "Table", "Table of stars", "T", actions.openTable, "open-table"],
    ["upload", "Import", "Put a drawing on the sheet: SVG, DXF or 3DM", "I", actions.chooseDrawing, "import-drawing"],
    ["help", "Help", "Keys and help", "?", actions.openHelp, "open-help"],
  ].map(([picture, text, title, keys, onclick, testid]) => toolButton({ picture, text, title, keys, testid, onclick }));
  element.append(group, h("span", { class: "gap" }), ...more);
  const [table] = more;
  const update = () => {
    const isOfRods = Boolean(store.get("sheet")?.isOfRods);
    if (isOfRods && tools[store.get("tool")].needsStars) return actions.choose("gradient");
    if (isOfRods) fitBrushToRods(store);
    for (const one of buttons) {
      one.setAttribute("aria-checked", String(one.dataset.tool === store.get("tool")));
      one.hidden = isOfRods && Boolean(tools[one.dataset.tool].needsStars);
    }
    table.hidden = isOfRods;
  };
  store.on(["tool", "sheet"], update);
  update();
}
