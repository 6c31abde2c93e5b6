// What the page does with the server's messages.

import { holesOf } from "./border.js";
import { addressOf } from "./dom.js";
import { date, plainField } from "./format.js";
import { forgetRefused, showFault } from "./panels/fields.js";
import { openKept } from "./panels/history.js";
import { announce, toast } from "./panels/toasts.js";
import { ofDesign } from "./store.js";

export function listen(studio) {
  const { store, connection, edits } = studio;

  const takers = {
    document(message) {
      const before = store.get("document");
      const isOther = before?.number !== message.number;
      if (isOther && before) forgetDesign();
      connection.document = message.number;
      edits.arrived(message);
      if (isOther) {
        studio.opened += 1;
        studio.plan.fit();
      }
      prune();
      const kept = message.kept_work.length;
      if (kept && (!before?.kept_work.length || before.path !== message.path)) offerKeptWork(message.kept_work);
      if (!kept) document.querySelector("[data-text*='left unsaved changes']")?.remove();
    },
    state(message) {
      const { settling } = message;
      if (settling) settling.begun = performance.now() / 1000 - settling.seconds;
      store.set({ state: message, problem: message.problem ? { ...message.problem, isBlocking: true } : null });
      if (message.jobs) store.set({ jobs: message.jobs });
    },
    history: (message) => store.set({ history: message.states }),
    kept: (message) => store.set({ kept: message.states }),
    gallery: (message) => store.set({ gallery: message }),
    progress(message) {
      store.set({ jobs: { ...store.get("jobs"), [message.job]: message } });
    },
    result(message) {
      const { [message.job]: done, ...jobs } = store.get("jobs");
      store.set({ jobs, results: { ...store.get("results"), [message.job]: message } });
      if (message.job === "verify") announce(message.cancelled ? "Verification cancelled" : "Verification finished");
      if (message.job === "fit") fitted(message);
      const written = { report: "The report is written.", animate: "The animated picture is written." }[message.job];
      if (written && message.files?.length) {
        const open = () => window.open(addressOf(message.files[0].name), "_blank", "noopener");
        toast(written, { action: { text: "Open it", run: open } });
      }
    },
    problem(message) {
      if (message.kind?.startsWith("file ")) return offerFile(message);
      const shown = showProblem(message);
      store.set({ problem: { ...message, isBlocking: false } });
      if (!shown) toast(textOf(message), { isBad: message.kind !== "search ended", action: placeAction(message) });
    },
    followed: (message) => toast(`${fileName(message.path)} was changed by another program; it is shown.`),
    saved: (message) => toast(`Saved as ${message.path}`, { stay: 4000 }),
    note: (message) => toast(message.text),
  };

  /** Another design is open: what was said, chosen, found and begun for the one before goes with it. */
  function forgetDesign() {
    edits.drop();
    forgetRefused();
    Object.values(studio.tools).forEach(({ tool }) => tool.cancel?.());
    document.querySelectorAll("dialog[open]").forEach((one) => one.close());
    document.querySelectorAll(".toast").forEach((one) => one.remove());
    studio.view?.reset();
    store.set(ofDesign());
  }

  /** The fitted design is shown; it is one step that can be undone. */
  function fitted({ summary, cancelled, revision }) {
    announce(cancelled ? "Fit cancelled" : "Fit finished");
    if (!summary) return;
    studio.actions.fitSoon(revision - 1);
    toast("The design is fitted to the target.", { action: { text: "Undo", run: studio.actions.undo } });
  }

  /** In the dialog, or at the field, if one is on the page. Returns whether it was. */
  function showProblem({ field, text }) {
    const own = document.querySelector("dialog[open] .fault.any");
    if (own) {
      own.textContent = text;
      own.hidden = false;
      return true;
    }
    if (!field) return false;
    const name = plainField(field);
    const element = [...document.querySelectorAll("[data-field]")].find(
      (one) => one.dataset.field === name && one.offsetParent,
    );
    const line = element?.querySelector(":scope > .fault");
    if (!line) return false;
    showFault(line, text, element, "bad");
    announce(text);
    return true;
  }

  /** The file on the disk is not the one that would be replaced. */
  function offerFile(message) {
    const isOther = message.kind !== "file changed";
    toast(`${message.text}. Nothing is written yet.`, {
      isBad: true,
      action: { text: isOther ? "Replace it" : "Keep mine", run: () => studio.actions.keepMine(message) },
      other: isOther ? null : { text: "Take the file's", run: studio.actions.takeFile },
      stay: 0,
    });
  }

  /** Unsaved work of other sessions. */
  function offerKeptWork([{ name, time }, ...others]) {
    if (others.length) {
      const action = { text: "See them", run: () => openKept(studio) };
      return toast("Earlier sessions left unsaved changes.", { action, stay: 0 });
    }
    toast(`An earlier session left unsaved changes, ${date(time)}.`, {
      action: { text: "Bring them back", run: () => connection.send("recover", { name }) },
      other: { text: "Forget them", run: () => connection.send("discard", { name }) },
      stay: 0,
    });
  }

  function placeAction({ stars = [], at_mm: at }) {
    if (!stars?.length && !at) return null;
    return { text: "Show", run: () => studio.actions.showPlace({ stars: stars ?? [], at_mm: at }) };
  }

  /** Drops selected stars that the document does not have any more. */
  function prune() {
    const sheet = store.get("sheet");
    const selection = [...store.get("selection")].filter((key) => sheet.byKey.has(key));
    if (selection.length !== store.get("selection").size) store.set({ selection: new Set(selection) });
    const support = store.get("support");
    const table = support && sheet.tables[support.table];
    if (support && (!table || (support.point !== null && table.points_mm && !table.points_mm[support.point])))
      store.set({ support: null });
    if (store.get("hole") >= holesOf(sheet).length && !edits.isWaiting) store.set({ hole: null });
  }

  store.on(["badge"], ({ badge }) => ["preview", "exact"].includes(badge.kind) && announce(badge.words));

  return {
    message: (message) => takers[message.type]?.(message),
    frame(frame) {
      if (studio.view) return studio.view.take(frame);
      const { kind, header } = frame; // nothing is drawn, but numbers are shown
      if (kind !== 2) return;
      store.set({ frame: header });
      connection.acknowledge(header.frame);
    },
    blocked: () =>
      toast(
        `The server answers, but no websocket opens: a proxy or a browser extension blocks it. Reach ${location.hostname} without the proxy.`,
        { isBad: true, stay: 0 },
      ),
    status(connected) {
      const before = store.get("connection");
      store.set({ connection: connected });
      if (connected === "lost") {
        edits.reconnected();
        if (before === "open")
          toast(
            "The studio does not answer; your work is kept in the autosave, and what you draw now follows when it answers again. If its terminal has ended, start it again and use the new address.",
            { isBad: true, stay: 0 },
          );
      } else if (connected === "open") {
        edits.reconnected();
        document
          .querySelectorAll(".toast.bad")
          .forEach((one) => one.dataset.text.startsWith("The studio does not answer") && one.remove());
        store.set({ jobs: {} });
        if (!store.get("showBumps")) connection.send("bumps", { shown: false });
      }
    },
  };
}

function textOf({ text, allowed }) {
  return allowed && !text.includes(String(allowed)) ? `${text} Allowed: ${allowed}.` : text;
}

const fileName = (path) => path.split(/[\\/]/).at(-1);
