// All shortcuts, and the overlay that lists them.

import { ARROWS, dialog, h, isDelete, section, signOf } from "./dom.js";
import { QUANTITIES, mm, sizesOf } from "./format.js";
import { difference } from "./geometry.js";
import { announce } from "./panels/toasts.js";
import { VIEWS } from "./view/camera.js";
import { turnByKey } from "./view/pointer.js";

const HELP = {
  Everywhere: [
    ["Ctrl+Z", "Undo"],
    ["Ctrl+Shift+Z", "Redo"],
    ["Ctrl+S", "Save"],
    ["Ctrl+O", "Open"],
    ["Ctrl+E", "Export"],
    ["V B G O N W R", "Select, brush, sizes, outline, needles, weight, ruler"],
    ["T", "Table of stars"],
    ["I", "Put a drawing on the sheet"],
    ["Esc", "Call off a stroke, cancel what runs, clear the selection"],
    ["?", "This help"],
  ],
  Plan: [
    ["← ↑ → ↓", "Go to the next star"],
    ["Enter", "Use the tool at the star: paint, select, set a needle, cut a hole, an end of a line"],
    ["+ −", "Change the size of the selected stars, of the selected hole"],
    ["Delete", "Remove stars, a corner, a hole or a needle"],
    ["Insert", "A corner after the selected one"],
    ["Shift+click", "Straight line with the brush; add to the selection"],
    ["Alt+click", "Take away from the selection; the brush subtracts"],
    ["Double click", "Select the ring"],
    ["Ctrl+A", "Select all stars"],
    ["Ctrl+C, Ctrl+V", "Copy the sizes of a star, give them to the selected ones"],
    ["[ ]", "Radius of the brush"],
    ["Page up, Page down", "Lift or lower a needle"],
    ["S, P", "Snapping, frame and printable area"],
    ["Space+drag, right drag", "Move the plan"],
    ["Wheel, F", "Zoom, fit"],
  ],
  Shape: [
    ["Drag, ← ↑ → ↓", "Turn"],
    ["Shift+drag, right drag", "Move"],
    ["Wheel, + −", "Zoom"],
    ["1 … 7", "Perspective, top, bottom, front, back, left, right"],
    ["O", "Orthographic"],
    ["D", "Paint on the sheet; a drag beside it turns"],
    ["F", "Fit"],
  ],
};

const SWITCHES = { s: "snap", p: "printArea", d: "paintOnSheet" };

export function openHelp() {
  const row = ([keys, does]) => h("tr", h("td", keys.split(", ").map((one) => h("kbd", one))), h("td", does));
  const block = ([title, rows]) => h("div", section(title), h("table.small.keys", h("tbody", rows.map(row))));
  dialog("Keys", h("div.help-columns", Object.entries(HELP).map(block)), { testid: "help-dialog" });
}

/** Handles keys on the whole page. Text fields keep theirs. */
export function listenToKeys({ store, actions, plan, view, edits, tools }) {
  addEventListener("keydown", (event) => {
    if (document.querySelector("dialog[open]")) return;
    const isTyping = event.target.matches?.("input:not([type=checkbox]):not([type=range]), textarea, select");
    if (event.ctrlKey || event.metaKey) return void (withControl(event, isTyping) && event.preventDefault());
    if (isTyping || event.altKey) return;
    if (event.key === " " && (event.target === plan.canvas || event.target === document.body)) {
      plan.isSpaceDown = true;
      event.preventDefault();
      return;
    }
    const onView = event.target === view?.canvas;
    const onPlan = event.target === plan.canvas || event.target === document.body;
    const isDone = (onView && onViewKey(event)) || (onPlan && onPlanKey(event)) || anywhere(event);
    if (isDone) event.preventDefault();
  });
  addEventListener("keyup", (event) => {
    if (event.key === " ") plan.isSpaceDown = false;
  });

  /** The brush whose radius changes: that of the tool, if it has one. */
  function brush() {
    const { tool } = tools[store.get("tool")];
    return tool.grow ? tool : tools.brush.tool;
  }

  function withControl(event, isTyping) {
    const key = event.key.toLowerCase();
    if (key === "s") actions.save();
    else if (key === "o") actions.openStart();
    else if (key === "e" && store.get("document")) actions.openExport();
    else if (isTyping) return false;
    else if (key === "z" && event.shiftKey) actions.redo();
    else if (key === "z") actions.undo();
    else if (key === "y") actions.redo();
    else if (key === "a") actions.selectAll();
    else if (key === "c" && !event.shiftKey && String(getSelection()) === "") actions.copySizes();
    else if (key === "v" && !event.shiftKey) actions.pasteSizes();
    else return false;
    return true;
  }

  function anywhere(event) {
    const key = event.key.toLowerCase();
    const tool = Object.keys(tools).find((name) => tools[name].keys.toLowerCase() === key);
    if (tool) actions.choose(tool);
    else if (event.key === "?") openHelp();
    else if (key === "t") actions.openTable();
    else if (key === "i") actions.chooseDrawing();
    else if (key === "[" || key === "]") brush().grow(key === "]" ? 1 : -1);
    else if (key in SWITCHES) store.set({ [SWITCHES[key]]: !store.get(SWITCHES[key]) });
    else if (key === "f") plan.fit();
    else if (event.key === "Escape") actions.escape();
    else return false;
    return true;
  }

  function onViewKey(event) {
    const name = Object.keys(VIEWS)[Number(event.key) - 1];
    if (turnByKey(event, view)) return true;
    if (name) view.look(name);
    else if (event.key.toLowerCase() === "o") store.set({ orthographic: !store.get("orthographic") });
    else return false;
    view.invalidate();
    return true;
  }

  function onPlanKey(event) {
    const sheet = store.get("sheet");
    if (!sheet) return false;
    if (tools[store.get("tool")].tool.key?.(event)) return true;
    const step = ARROWS[event.key];
    if (step) return go(sheet, step);
    if (event.key === "Enter" && store.get("cursor")) {
      const selection = new Set(store.get("selection"));
      if (!selection.delete(store.get("cursor"))) selection.add(store.get("cursor"));
      store.set({ selection });
    } else if (signOf(event)) grow(sheet, signOf(event));
    else if (isDelete(event)) actions.removeSelected();
    else return false;
    return true;
  }

  /** To the nearest star in a direction. */
  function go(sheet, direction) {
    const from = sheet.byKey.get(store.get("cursor"));
    let best = from ? null : sheet.starAt(sheet.centre, Infinity);
    let least = Infinity;
    for (const star of from ? sheet.stars : []) {
      const off = difference(star.at, from.at);
      const along = off[0] * direction[0] + off[1] * direction[1];
      const across = Math.abs(off[0] * direction[1] - off[1] * direction[0]);
      if (along > 1e-6 && across < 1.8 * along && along + 2 * across < least)
        [best, least] = [star, along + 2 * across];
    }
    if (!best) return true;
    store.set({ cursor: best.key, hover: best.key });
    const said = best.removed ? "removed" : sizesOf(best, ({ name }, size) => `${name.toLowerCase()} ${size}`);
    announce(`Star ${best.row}, x ${mm(best.at[0])}, y ${mm(best.at[1])}, ${said}`);
    return true;
  }

  /** One step larger or smaller, of the selected stars or the one of the keyboard. */
  function grow(sheet, sign) {
    const { quantity } = store.get("brush");
    const { column, step, name } = QUANTITIES[quantity];
    const more = sign * (sheet.printable(quantity)?.step ?? step);
    const values = new Map(
      actions.chosen().map((star) => [star.key, sheet.allowed(quantity, star.sizes[column] + more, store.get("inLaw"))]),
    );
    if (!values.size) return;
    edits.once(() => edits.sizes(quantity, values));
    announce(`${name} ${mm([...values.values()][0], 2)}`);
  }
}
