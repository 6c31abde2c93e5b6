// Pointers over the view: orbit, pan, zoom, pinch; lifting a needle by its head; hover and click on stars; strokes of a
// brush on the sheet, where that is switched on.

import { selected } from "../plan/tools/select.js";
import { isChosen, isPoints, membersOf, pointsOf, targetsOf, withChosen, withShifted } from "../supports.js";
import { headOf } from "./solids.js";

const GRIP_PX = 16;
const CLICK_PX = 4;

export function listenToView(view, { store, edits, tools }) {
  const { canvas } = view;
  const pointers = new Map();
  let last = null;
  let drag = null;
  let way = 0;

  canvas.addEventListener("keydown", () => delete canvas.dataset.pointer);
  canvas.addEventListener("blur", () => delete canvas.dataset.pointer);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.dataset.pointer = "";
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    last = span();
    way = 0;
    if (drag?.target) edits.cancel(); // a second finger
    drag?.brush?.cancel();
    const needle = pointers.size === 1 && event.button === 0 ? needleUnder(event) : null;
    drag = event.button === 0 && !event.shiftKey ? "orbit" : "pan";
    if (needle) {
      const { table, point, target } = needle;
      const [one, support, { tables, pins }] = [{ table, point }, store.get("support"), store.get("sheet")];
      const members = isChosen(support, one) ? membersOf(support) : [one];
      drag = { target, members, tables, pins, y: event.clientY };
      if (event.ctrlKey || event.metaKey) return void store.set({ support: withChosen(support, one) });
      if (members.length === 1) store.set({ support: one });
      edits.begin();
      return;
    }
    const brush = pointers.size === 1 && event.button === 0 ? brushOf() : null;
    const stroke = brush && strokeAt(event);
    if (!stroke) return;
    drag = { brush };
    brush.down(stroke);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return hover(event);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const now = span();
    const [dx, dy] = [now.x - last.x, now.y - last.y];
    way += Math.hypot(dx, dy);
    if (pointers.size > 1) {
      view.camera.zoom(now.length / last.length);
      view.camera.pan(dx, dy, canvas.clientHeight);
    } else if (drag?.target) return liftTo(event);
    else if (drag?.brush) return paint(event);
    else if (drag === "orbit") view.camera.orbit(dx, dy);
    else view.camera.pan(dx, dy, canvas.clientHeight);
    last = now;
    view.invalidate();
  });
  const lifted = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (drag?.target) edits.end();
    else if (drag?.brush) drag.brush[event.type === "pointerup" ? "up" : "cancel"]();
    else if (way < CLICK_PX && event.type === "pointerup") click(event);
    drag = pointers.size ? "pan" : null;
    if (pointers.size) last = span();
  };
  canvas.addEventListener("pointerup", lifted);
  canvas.addEventListener("pointercancel", lifted);
  canvas.addEventListener("pointerleave", () => (brushOf() ? brushOf().leave() : store.set({ hover: null })));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      view.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.04 : 0.0013)));
      view.invalidate();
    },
    { passive: false },
  );

  function span() {
    const all = [...pointers.values()];
    const [x, y] = [0, 1].map((k) => all.reduce((total, at) => total + at[k], 0) / all.length);
    const length = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 1;
    return { x, y, length: Math.max(length, 1) };
  }

  function starUnder(event) {
    const place = view.printedAt(event);
    return place && store.get("sheet")?.starAt(place);
  }

  /** The brush that paints on the sheet, or null. */
  function brushOf() {
    if (!store.get("paintOnSheet")) return null; // always so in a notebook, which has no tools
    const { tool } = tools[store.get("tool")];
    return tool.dab ? tool : null;
  }

  /** The event as a tool of the plan gets it; null beside the sheet. */
  function strokeAt(event) {
    const at = view.printedAt(event);
    if (!at) return null;
    return { at, shift: event.shiftKey, alt: event.altKey, force: event.pointerType === "pen" ? event.pressure : 1 };
  }

  function paint(event) {
    const stroke = strokeAt(event);
    if (!edits.isOpen) return; // called off
    if (!stroke) drag.isOff = true;
    else if (drag.isOff) drag.brush.down({ ...stroke, shift: false }); // no line to where the stroke comes back
    else drag.brush.move(stroke);
    if (stroke) drag.isOff = false;
  }

  function hover(event) {
    const brush = brushOf();
    const stroke = brush && strokeAt(event);
    if (stroke) {
      canvas.style.cursor = "crosshair";
      return brush.hover(stroke);
    }
    brush?.leave();
    store.set({ hover: starUnder(event)?.key ?? null });
    canvas.style.cursor = needleUnder(event) ? "ns-resize" : "grab";
  }

  function click(event) {
    const keys = [starUnder(event)?.key].filter(Boolean);
    store.set({ selection: selected(store, keys, { shift: event.shiftKey, alt: event.altKey }, true) });
  }

  function needleUnder(event) {
    const sheet = store.get("sheet");
    if (!sheet || !view.shape || store.get("tool") !== "needles") return null;
    const [px, py] = view.place(event);
    let best = null;
    sheet.tables.forEach((table, number) => {
      if (!isPoints(table)) return;
      const targets = targetsOf(table, sheet.pins[number]);
      pointsOf(table, sheet.pins[number]).forEach((_, point) => {
        const target = targets[point];
        const [x, y] = view.camera.project(headOf(target), view.aspect);
        const away = Math.hypot(((x - px) * canvas.clientWidth) / 2, ((y - py) * canvas.clientHeight) / 2);
        if (away < GRIP_PX && (!best || away < best.away)) best = { table: number, point, target, away };
      });
    });
    return best;
  }

  function liftTo(event) {
    if (!edits.isOpen) return; // called off
    const { target, members, tables, pins, y } = drag;
    const height = Math.max(0, target[2] + (y - event.clientY) * view.camera.pixelMm(canvas.clientHeight));
    const lifted = withShifted(tables, pins, members, [0, 0, Math.round(height * 2) / 2 - target[2]]);
    edits.design({ pins: lifted }, { pins: lifted });
  }
}
