// What buttons and keys do.

import { isLong } from "./badge.js";
import { borderOf } from "./border.js";
import { h, isDark } from "./dom.js";
import { askUnit, openDrawing } from "./panels/drawing.js";
import { openExport } from "./panels/export.js";
import { openHistory } from "./panels/history.js";
import { QUANTITIES, plural } from "./format.js";
import { announce, toast } from "./panels/toasts.js";
import { openTable } from "./table.js";
import { openHelp } from "./keys.js";

export function createActions(studio) {
  const { store, connection, edits } = studio;

  const asked = new Map(); // files that were to be saved, by the number of the message
  function send(type, fields) {
    const about = { document: connection.document, ...fields };
    asked.set(connection.send(type, about), about);
  }

  /** Has the engine search; the page says so before the server does. */
  function search(what, fields) {
    if (connection.send(what, fields)) store.set({ state: { ...store.get("state"), searching: what } });
  }

  /** Has the server begin a job; the page says so before the server does. */
  function begin(job, fields) {
    const jobs = { ...store.get("jobs"), [job]: { stage: "starts", done: 0, of: 0, seconds: 0 } };
    store.set({ jobs, results: { ...store.get("results"), [job]: null } });
    connection.send(job, fields);
  }

  const actions = {
    // a hole is chosen by its number, which another state of the design may give to another
    undo: () => (store.set({ hole: null }), connection.send("undo")),
    redo: () => (store.set({ hole: null }), connection.send("redo")),
    save: () => store.get("document") && send("save", {}),
    saveAs: (name) => send("save", { name }),
    /** After the server has refused to write over a file: write all the same, or show what the file holds. */
    keepMine: ({ seq }) => send("save", { ...asked.get(seq), over: true }),
    takeFile: () => connection.send("reread"),
    report: () => begin("report"),
    spread: () => begin("spread"),
    animate: () => begin("animate"),
    writeFiles: (fields) => begin("export", fields),
    cancel: () => connection.send("cancel"),
    flip: () => search("flip"),
    showForm: (index) => search("form", { index }),
    showExactForm: (released) => connection.send("exact-form", { released }),
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
      store.set({ page: "shape" });
      begin("verify");
    },
    /** Fits outline, stars and supports to the target; `hold` is "auto", "border" or "nothing". */
    fitToTarget: (hold) => begin("fit", { hold }),
    choose: (tool) => store.set({ tool, page: "tool", hover: null }),
    showPage: (page) => store.set({ page }),
    showPlace({ stars = [], at_mm: at }) {
      const sheet = store.get("sheet");
      const keys = stars.map((site) => site.join(","));
      const known = keys.map((key) => sheet.byKey.get(key)).filter(Boolean);
      if (known.length) store.set({ selection: new Set(keys) });
      const place = at ?? known[0]?.at;
      if (place) studio.plan.show(place);
    },
    selectAll: () => store.set({ selection: new Set(store.get("sheet")?.stars.map((star) => star.key)) }),
    /** The selected stars that are there; without a selection that of the keyboard. */
    chosen() {
      const keys = store.get("selection").size ? [...store.get("selection")] : [store.get("cursor")];
      return keys.map((key) => store.get("sheet")?.byKey.get(key)).filter((star) => star?.removed === false);
    },
    removeSelected() {
      const keys = actions.chosen().map((star) => star.key);
      if (keys.length) edits.once(() => edits.remove(keys));
    },
    /** The sizes of the first of the chosen stars, which others can get. */
    copySizes() {
      const [star] = actions.chosen();
      if (!star) return;
      const copied = Object.entries(QUANTITIES).map(([quantity, { column }]) => [quantity, star.sizes[column]]);
      store.set({ copied });
      toast("Sizes copied.", { stay: 2000 });
    },
    pasteSizes() {
      const [stars, copied] = [actions.chosen(), store.get("copied")];
      if (!stars.length || !copied) return;
      edits.once(() =>
        copied.forEach(([quantity, value]) => edits.sizes(quantity, new Map(stars.map(({ key }) => [key, value])))),
      );
      announce(`Sizes of ${plural(stars.length, "star")} changed`);
    },
    escape() {
      if (studio.plan.cancel() || edits.isOpen) edits.cancel();
      else if (store.get("startOpen")) store.set({ startOpen: false });
      else if (isLong(store.get("state"))) actions.stop();
      else if (Object.keys(store.get("jobs")).length) actions.cancel();
      else store.set({ selection: new Set(), support: null, corner: null, hole: null });
    },
    /** The plan shows all of a sheet that gets another outline, as soon as there is a state after `before`. */
    fitSoon(before = store.get("document")?.revision) {
      const { document } = connection;
      const fitPlan = () => {
        const isOther = document !== connection.document;
        if (!isOther && store.get("document").revision <= before) return;
        stop();
        if (!isOther) studio.plan.fit();
      };
      const ends = [
        store.on(["document"], fitPlan),
        store.on(["problem"], ({ problem }) => problem?.isBlocking === false && stop()), // refused
      ];
      const stop = () => ends.forEach((end) => end());
      fitPlan();
    },
    switchTheme: () => store.set({ theme: isDark() ? "light" : "dark" }),
    upload,
    chooseDrawing: () => choose("drawing", ".svg,.dxf,.3dm", actions.takeDrawing),
    /** On the first page, a drawing begins a design of its own. */
    takeDrawing: (file) => takeDrawing(file, !store.get("document") || store.get("startOpen")),
    takeTarget: (file) => sendFile("target", file, { document: connection.document }),
  };

  /** A file chosen by the person goes to the server, which reads it; its answer becomes an edit of the design of then. */
  function upload(kind, accept, use = null) {
    const { document } = connection;
    choose(kind, accept, async (file) => {
      const told = await sendFile(kind, file, { document });
      if (!told || document !== connection.document) return;
      if (use) use(told.value);
      else if (told.border) {
        edits.once(() => edits.design({ border: borderOf(store.get("sheet").design, told.border) }));
        actions.fitSoon();
      }
    });
  }

  function choose(kind, accept, take) {
    const onchange = () => {
      const [file] = input.files;
      input.remove();
      if (file) take(file);
    };
    const oncancel = () => input.remove();
    const input = h("input", { type: "file", accept, testid: `file-${kind}`, hidden: true, onchange, oncancel });
    document.body.append(input);
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

  /** A drawing goes to the server, which may ask for its unit, and then to its dialog, on the open sheet or on a new one. */
  async function takeDrawing(file, isNew, more = {}) {
    const { document } = connection;
    const told = await sendFile("drawing", file, more);
    if (!told || (!isNew && document !== connection.document)) return;
    if (told.units) askUnit(file.name, told.units, (units) => takeDrawing(file, isNew, { units }));
    else if (!isNew || (await newSheet())) openDrawing(studio, told.drawing);
  }

  /** Whether a new sheet is open; false if the connection is lost before. */
  function newSheet() {
    const before = connection.document;
    return new Promise((resolve) => {
      const stop = store.on(["document", "connection"], () => {
        const isOpen = connection.document !== before;
        if (!isOpen && store.get("connection") === "open") return;
        stop();
        resolve(isOpen);
      });
      actions.startNew();
    });
  }

  /** The open design stays until another one is there. */
  function leave() {
    edits.drop();
    store.set({ startOpen: false });
  }

  return actions;
}
