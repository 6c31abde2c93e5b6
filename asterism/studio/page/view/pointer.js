// Pointers over the view: orbit, pan, zoom, pinch; lifting a needle by its head; hover and click on stars; strokes of a
// brush on the sheet, where that is switched on.

import { ARROWS, signOf } from "../dom.js";
import { nearest } from "../geometry.js";
import { listenToPointers } from "../pointers.js";
import { selected } from "../plan/tools/select.js";
import { isChosen, isPoints, membersOf, needlesOf, withChosen, withShifted } from "../supports.js";
import { headOf } from "./solids.js";

const GRIP_PX = 16;
const CLICK_PX = 4;

/** Arrows turn the sheet, + and − zoom, F shows all of it. Returns whether the key did something. */
export function turnByKey(event, view) {
  const turn = ARROWS[event.key];
  if (turn) view.camera.orbit(...turn.map((value) => 12 * value));
  else if (signOf(event)) view.camera.zoom(1.15 ** signOf(event));
  else if (event.key.toLowerCase() === "f") view.fit();
  else return false;
  view.invalidate();
  return true;
}

export function listenToView(view, { store, edits, tools }) {
  const { canvas } = view;
  let drag = null; // what the pressed pointer does
  let way = 0;
  const pan = ([dx, dy]) => view.camera.pan(dx, dy, canvas.clientHeight);

  listenToPointers(canvas, {
    down(event) {
      way = 0;
      const isFirst = event.button === 0;
      const needle = isFirst ? needleUnder(event) : null;
      drag = isFirst && !event.shiftKey ? "orbit" : "pan";
      if (needle) return grip(event, needle);
      const brush = isFirst ? brushOf() : null;
      const stroke = brush && strokeAt(event);
      if (!stroke) return;
      drag = { brush };
      brush.down(stroke);
    },
    move(event, step) {
      way += Math.hypot(...step);
      if (drag.target) return liftTo(event);
      if (drag.brush) return paint(event);
      if (drag === "orbit") view.camera.orbit(...step);
      else pan(step);
      view.invalidate();
    },
    up(event) {
      if (drag.target) edits.end();
      else if (drag.brush) drag.brush.up();
      else if (way < CLICK_PX) click(event);
    },
    cancel() {
      if (drag.target) edits.cancel();
      drag.brush?.cancel();
    },
    hover,
    leave: () => (brushOf() ? brushOf().leave() : store.set({ hover: null })),
    pinch({ factor, step }) {
      view.camera.zoom(factor);
      pan(step);
      view.invalidate();
    },
    wheel(event) {
      view.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.04 : 0.0013)));
      view.invalidate();
    },
  });

  /** A press on the head of a needle lifts it, and those that are chosen with it. */
  function grip(event, { table, point, target }) {
    const [one, support, { tables, pins }] = [{ table, point }, store.get("support"), store.get("sheet")];
    const members = isChosen(support, one) ? membersOf(support) : [one];
    drag = { target, members, tables, pins, y: event.clientY };
    if (event.ctrlKey || event.metaKey) return store.set({ support: withChosen(support, one) });
    if (members.length === 1) store.set({ support: one });
    edits.begin();
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
    const needles = needlesOf(sheet).filter(({ table }) => isPoints(sheet.tables[table]));
    const seen = needles.map((one) => {
      const [x, y] = view.camera.project(headOf(one.target), view.aspect);
      return { ...one, away: Math.hypot(((x - px) * canvas.clientWidth) / 2, ((y - py) * canvas.clientHeight) / 2) };
    });
    return nearest(seen, GRIP_PX);
  }

  function liftTo(event) {
    if (!edits.isOpen) return; // called off
    const { target, members, tables, pins, y } = drag;
    const height = Math.max(0, target[2] + (y - event.clientY) * view.camera.pixelMm(canvas.clientHeight));
    const lifted = withShifted(tables, pins, members, [0, 0, Math.round(height * 2) / 2 - target[2]]);
    edits.design({ pins: lifted }, { pins: lifted });
  }
}
