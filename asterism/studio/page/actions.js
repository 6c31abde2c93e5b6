// What buttons and keys do.

import { askUnit, openDrawing } from "./panels/drawing.js";
import { openExport } from "./panels/export.js";
import { openHistory } from "./panels/history.js";
import { toast } from "./panels/toasts.js";
import { isLong } from "./store.js";
import { openTable } from "./table.js";
import { openHelp } from "./keys.js";

export function createActions(studio) {
  const { store, connection, edits } = studio;

  const asked = new Map(); // files that were to be saved, by the number of the message
  const send = (type, fields) => asked.set(connection.send(type, fields), fields);

  /** Has the engine search; the page says so before the server does. */
  function search(what, fields) {
    if (connection.send(what, fields)) store.set({ state: { ...store.get("state"), searching: what } });
  }

  const actions = {
    undo: () => connection.send("undo"),
    redo: () => connection.send("redo"),
    save: () => store.get("document") && send("save", {}),
    saveAs: (name) => send("save", { name }),
    /** After the server has refused to write over a file: write all the same, or show what the file holds. */
    keepMine: ({ seq }) => send("save", { ...asked.get(seq), over: true }),
    takeFile: () => connection.send("reread"),
    report() {
      store.set({ jobs: { ...store.get("jobs"), report: { stage: "starts", done: 0, of: 0, seconds: 0 } } });
      connection.send("report");
    },
    cancel: () => connection.send("cancel"),
    flip: () => search("flip"),
    showForm: (index) => search("form", { index }),
    stop: () => connection.send("stop"),
    openHistory: () => openHistory(studio),
    openTable: () => store.get("document") && openTable(studio),
    openHelp,
    openExport: () => openExport(studio),
    openStart() {
      connection.send("gallery");
      store.set({ startOpen: true });
    },
    open(what) {
      leave();
      connection.send("open", what);
    },
    startNew() {
      leave();
      connection.send("new");
    },
    verify() {
      const jobs = { ...store.get("jobs"), verify: { stage: "starts", done: 0, of: 0, seconds: 0 } };
      store.set({ jobs, results: { ...store.get("results"), verify: null }, page: "shape" });
      connection.send("verify");
    },
    /** Fits outline, stars and supports to the target; `hold` is "auto", "border" or "nothing". */
    fitToTarget(hold) {
      const jobs = { ...store.get("jobs"), fit: { stage: "starts", done: 0, of: 0, seconds: 0 } };
      store.set({ jobs, results: { ...store.get("results"), fit: null } });
      connection.send("fit", { hold });
    },
    choose(tool) {
      store.set({ tool, page: "tool", hover: null });
    },
    showPage: (page) => store.set({ page }),
    showPlace({ stars = [], at_mm: at }) {
      const sheet = store.get("sheet");
      const keys = stars.map((site) => site.join(","));
      const known = keys.map((key) => sheet.byKey.get(key)).filter(Boolean);
      if (known.length) store.set({ selection: new Set(keys) });
      const place = at ?? known[0]?.at;
      if (place) studio.plan.show(place);
    },
    selectAll() {
      store.set({ selection: new Set(store.get("sheet")?.stars.map((star) => star.key)) });
    },
    removeSelected() {
      const sheet = store.get("sheet");
      let keys = [...store.get("selection")];
      if (!keys.length && store.get("cursor")) keys = [store.get("cursor")];
      keys = keys.filter((key) => sheet.byKey.get(key)?.removed === false);
      if (!keys.length) return;
      edits.once(() => edits.remove(keys));
    },
    escape() {
      if (store.get("startOpen")) store.set({ startOpen: false });
      else if (isLong(store.get("state"))) actions.stop();
      else if (Object.keys(store.get("jobs")).length) actions.cancel();
      else store.set({ selection: new Set(), support: null, corner: null });
    },
    /** Plan and view show all of a sheet that gets another outline, as soon as they have a state after `before`. */
    fitSoon(before = store.get("document")?.revision) {
      let isPlanFitted = false;
      const fitPlan = () => {
        if (isPlanFitted || store.get("document").revision <= before) return;
        isPlanFitted = true;
        studio.plan.fit();
      };
      const ends = [
        store.on(["document"], fitPlan),
        store.on(["frame"], ({ frame }) => {
          if (frame?.stage !== "equilibrium" || frame.revision <= before) return;
          stop();
          requestAnimationFrame(() => studio.view?.fit());
        }),
        store.on(["startOpen"], () => stop()), // another design
        store.on(["problem"], ({ problem }) => problem?.isBlocking === false && problem.kind !== "no preview" && stop()), // refused
      ];
      const stop = () => ends.forEach((end) => end());
      fitPlan();
    },
    switchTheme() {
      const isDark = getComputedStyle(document.documentElement).colorScheme.trim() === "dark";
      store.set({ theme: isDark ? "light" : "dark" });
    },
    upload,
    chooseDrawing: () => choose("drawing", ".svg,.dxf,.3dm", takeDrawing),
    takeDrawing: (file) => takeDrawing(file),
    takeTarget: (file) => sendFile("target", file),
  };

  /** A file chosen by the person goes to the server, which reads it; its answer becomes an edit. */
  function upload(kind, accept, use = null) {
    choose(kind, accept, async (file) => {
      const told = await sendFile(kind, file);
      if (!told) return;
      if (use) use(told.value);
      else if (told.border) {
        edits.once(() => edits.design({ border: { ...rest(store.get("sheet").design.border), ...told.border } }));
        actions.fitSoon();
      }
    });
  }

  function choose(kind, accept, take) {
    const input = document.createElement("input");
    Object.assign(input, { type: "file", accept });
    input.dataset.testid = `file-${kind}`;
    input.hidden = true;
    document.body.append(input);
    input.addEventListener("change", () => {
      const [file] = input.files;
      input.remove();
      if (file) take(file);
    });
    input.addEventListener("cancel", () => input.remove());
    input.click();
  }

  /** Sends a file; the answer of the server, or null if there is none, which the page says. */
  async function sendFile(kind, file, more = {}) {
    try {
      const answer = await fetch(`upload?${new URLSearchParams({ kind, ...more })}`, {
        method: "POST",
        body: file,
        headers: { "X-Name": encodeURIComponent(file.name) },
      });
      const told = await answer.json();
      if (!told.problem) return told;
      toast(told.problem.text, { isBad: true });
    } catch {
      toast(`${file.name} could not be sent. Is the studio still running?`, { isBad: true });
    }
    return null;
  }

  /** A drawing goes to the server, which may ask for its unit, and then to its dialog; without a design, on a new sheet. */
  async function takeDrawing(file, more = {}) {
    if (!store.get("document")) await newSheet();
    const told = await sendFile("drawing", file, more);
    if (told?.units) askUnit(file.name, told.units, (units) => takeDrawing(file, { units }));
    else if (told) {
      store.set({ startOpen: false });
      openDrawing(studio, told.drawing);
    }
  }

  function newSheet() {
    return new Promise((resolve) => {
      const stop = store.on(["document"], ({ document }) => document && (stop(), resolve()));
      actions.startNew();
    });
  }

  function leave() {
    edits.drop();
    studio.view?.reset();
    store.set({
      startOpen: false,
      selection: new Set(),
      support: null,
      corner: null,
      cursor: null,
      results: {},
      frame: null,
    });
    studio.isNew = true;
  }

  return actions;
}

function rest({ rings, rectangle_mm, polygon_mm, ...kept } = {}) {
  return kept;
}
