// The bar at the top: name, saved mark, undo and redo, open, verify, export, report, theme; the tools on the left.

import { append, button, follow, h, show } from "../dom.js";
import { icon } from "../icons.js";
import { fitBrushToRods } from "./brush.js";
import { toast } from "./toasts.js";

const isNone = ({ document }) => !document;
const isBusy = ({ document, jobs }) => !document || Object.keys(jobs).length > 0; // one job runs at a time

// by their testids, which are also icons and actions unless these are named; `isOff`: of the values of the store
const BUTTONS = {
  undo: { label: "Undo", keys: "Ctrl+Z", isOff: ({ document }) => !document?.can_undo },
  redo: { label: "Redo", keys: "Ctrl+Shift+Z", isOff: ({ document }) => !document?.can_redo },
  history: { label: "Earlier states", run: "openHistory", isOff: isNone, isLast: true },
  open: { text: "Open", keys: "Ctrl+O", run: "openStart" },
  save: { text: "Save", keys: "Ctrl+S", isOff: isNone, isLast: true },
  report: { text: "Report", isOff: isBusy },
  export: { text: "Export", keys: "Ctrl+E", run: "openExport", isOff: isNone },
  verify: { text: "Verify", kind: "primary", isOff: isBusy },
  theme: { icon: "moon", label: "Light or dark", run: "switchTheme" },
};

export function buildTop(element, { store, actions }) {
  const now = () => store.get("document");
  const name = h("input", {
    "aria-label": "Name of the design file",
    title: "Name of the design file. Another name saves a copy.",
    testid: "name",
    maxLength: 100,
    spellcheck: false,
    disabled: () => !now(),
    onkeydown: (event) => {
      event.stopPropagation();
      if (event.key === "Enter") name.blur();
    },
    onchange: () => {
      const wanted = name.value.trim();
      name.value = now().name; // until the file is written: the server may refuse
      const refused = "A name has no slash: the file lies in the folder of the studio.";
      if (/[\\/]/.test(wanted)) toast(refused, { isBad: true });
      else if (wanted) actions.saveAs(wanted);
    },
  });
  const since = () => store.get("state").unsaved_since;
  const edited = () => (now().has_file ? "Edited" : "Not saved yet");
  const timeOf = (time) => new Date(1000 * time).toTimeString().slice(0, 5);
  const lost = () => since() && !now().saved && `Not saved since ${timeOf(since())}`;
  const kept = () => (now().saved || lost() ? "" : "\nUnsaved changes are kept in the autosave.");
  const saved = () => (now() ? (now().saved ? "Saved" : lost() || edited()) : "");
  const buttons = Object.entries(BUTTONS).map(([testid, { run = testid, kind = "plain", isOff, isLast, ...rest }]) => {
    const disabled = isOff && (() => isOff({ document: now(), jobs: store.get("jobs") }));
    const one = button({ icon: testid, testid, kind, onclick: actions[run], disabled, ...rest });
    return [one, isLast && h("span.rule")];
  });
  append(
    element,
    follow(store.on, ["document", "jobs", "state"], [
      h("span.brand", { title: "asterism studio" }, icon("logo")),
      h("span.name", name),
      h("span.saved", { testid: "saved", role: "status", title: () => (now() ? now().path + kept() : "") }, saved),
      h("span.gap"),
      buttons,
    ]),
  );
  const update = () => {
    if (document.activeElement !== name) name.value = now()?.name ?? "";
    document.title = now() ? `${now().saved ? "" : "• "}${now().name} · asterism studio` : "asterism studio";
  };
  store.on(["document", "jobs", "state"], update);
  update();
}

/** The strip of tools on the left. */
export function buildTools(element, { store, tools, actions }) {
  const toolButton = (picture, text, title, keys, onclick, testid, rest = {}) => {
    const props = { type: "button", title: `${title} (${keys})`, "aria-label": title, "aria-keyshortcuts": keys };
    return h("button.tool", { ...props, testid, onclick, ...rest }, icon(picture), h("span", text));
  };
  const isOfRods = () => Boolean(store.get("sheet")?.isOfRods);
  const buttons = Object.entries(tools).map(([name, { title, keys, needsStars }]) =>
    toolButton(name, title, title, keys, () => actions.choose(name), `tool-${name}`, {
      role: "radio",
      "aria-checked": () => String(store.get("tool") === name),
      hidden: () => isOfRods() && Boolean(needsStars),
    }),
  );
  const group = h("div", { role: "radiogroup", "aria-label": "Tool" }, buttons);
  group.style.display = "contents";
  const importTitle = "Put a drawing on the sheet: SVG, DXF or 3DM";
  const all = [
    group,
    h("span.gap"),
    toolButton("table", "Table", "Table of stars", "T", actions.openTable, "open-table", { hidden: isOfRods }),
    toolButton("upload", "Import", importTitle, "I", actions.chooseDrawing, "import-drawing"),
    toolButton("help", "Help", "Keys and help", "?", actions.openHelp, "open-help"),
  ];
  append(element, all);
  store.on(["tool", "sheet"], () => {
    if (isOfRods() && tools[store.get("tool")].needsStars) return actions.choose("gradient");
    if (isOfRods()) fitBrushToRods(store);
    show(all);
  });
}
