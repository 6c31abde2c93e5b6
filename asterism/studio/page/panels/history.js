// Earlier states of the design as small plans; one click shows one of them.

import { button, colourOf, dialog, h, hint, refresh } from "../dom.js";
import { date } from "../format.js";
import { smallPlan } from "./small_plan.js";

const [WIDTH_PX, HEIGHT_PX, MARGIN_PX] = [144, 108, 8];

/** A dialog with pictures of states, which the server lists under `key` when they are asked for. */
function openStates({ store, connection }, { key, title, about, testid, build }) {
  const list = h("div.thumbnails");
  const update = () => refresh(list, store.get(key), () => build(store.get(key) ?? []));
  const stops = [store.on([key], update), store.on(["document"], () => connection.send(key))];
  dialog(title, [hint(about), list], { testid, onclose: () => stops.forEach((stop) => stop()) });
  connection.send(key);
  update();
}

export function openHistory(studio) {
  const { store, connection } = studio;
  const thumbnail = (state) => {
    const onclick = () => (store.set({ hole: null }), connection.send("go", { position: state.position }));
    const isShown = String(Boolean(state.is_shown));
    const props = { type: "button", "aria-current": isShown, testid: `state-${state.position}`, onclick };
    return h("button.thumbnail", props, pictureOf(state), h("span", { title: state.words }, state.words));
  };
  openStates(studio, {
    key: "history",
    title: "Earlier states",
    about: "The newest is first. Undo and redo go through the same states.",
    testid: "history-dialog",
    build: (states) => (states.length ? states.map(thumbnail).reverse() : hint("There are no earlier states yet.")),
  });
}

/** The unsaved work of other sessions, each to be brought back or forgotten. */
export function openKept(studio) {
  const ask = (type, { name }) => () => studio.connection.send(type, { name });
  const about = (state) =>
    h("div.thumbnail", { testid: `kept-${state.name}` }, [
      pictureOf(state),
      h("span", date(state.time)),
      button({ text: "Bring it back", onclick: ask("recover", state) }),
      button({ text: "Forget it", onclick: ask("discard", state) }),
    ]);
  openStates(studio, {
    key: "kept",
    title: "Unsaved changes of earlier sessions",
    about: "The newest is first.",
    testid: "kept-dialog",
    build: (states) => states.map(about),
  });
}

/** Outline, and a dot for each star, as large as its arms; nothing if the sheet cannot be laid out. */
function pictureOf({ outline_mm: outline, at_mm: places, sizes_mm: sizes }) {
  const ratio = devicePixelRatio || 1;
  const canvas = h("canvas", { "aria-hidden": "true", width: WIDTH_PX * ratio, height: HEIGHT_PX * ratio });
  if (!outline) return canvas;
  const { context, at, scale, path } = smallPlan(canvas, outline, MARGIN_PX, ratio);
  context.strokeStyle = context.fillStyle = colourOf("ink");
  path(outline);
  context.closePath();
  context.stroke();
  context.globalAlpha = 0.65;
  places.forEach((place, k) => {
    const length = Array.isArray(sizes[k]) ? sizes[k][0] : sizes[k];
    context.beginPath();
    context.arc(...at(place), Math.max(0.3, 0.42 * scale * length), 0, 2 * Math.PI);
    context.fill();
  });
  return canvas;
}
