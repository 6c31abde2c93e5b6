// Earlier states of the design as small plans; one click shows one of them.

import { button, dialog, h, hint, refresh } from "../dom.js";
import { date } from "../format.js";
import { bounds } from "../geometry.js";

const WIDTH_PX = 144;
const HEIGHT_PX = 108;
const MARGIN_PX = 8;

/** A dialog with pictures of states, which the server lists under `key` when they are asked for. */
function openStates({ store, connection }, { key, title, about, testid, build }) {
  const list = h("div", { class: "thumbnails" });
  const update = () => refresh(list, store.get(key), () => build(store.get(key) ?? []));
  const stops = [store.on([key], update), store.on(["document"], () => connection.send(key))];
  dialog(title, [hint(about), list], { testid, onclose: () => stops.forEach((stop) => stop()) });
  connection.send(key);
  update();
}

/** A small plan; nothing if the sheet cannot be laid out. */
function pictureOf(state) {
  const picture = h("canvas", { "aria-hidden": "true" });
  if (state.outline_mm) draw(picture, state);
  return picture;
}

export function openHistory(studio) {
  const { store, connection } = studio;
  const thumbnail = (state) =>
    h(
      "button",
      {
        type: "button",
        class: "thumbnail",
        "aria-current": String(Boolean(state.is_shown)),
        testid: `state-${state.position}`,
        onclick: () => (store.set({ hole: null }), connection.send("go", { position: state.position })),
      },
      pictureOf(state),
      h("span", { title: state.words }, state.words),
    );
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
    h(
      "div",
      { class: "thumbnail", testid: `kept-${state.name}` },
      pictureOf(state),
      h("span", {}, date(state.time)),
      button({ text: "Bring it back", onclick: ask("recover", state) }),
      button({ text: "Forget it", onclick: ask("discard", state) }),
    );
  openStates(studio, {
    key: "kept",
    title: "Unsaved changes of earlier sessions",
    about: "The newest is first.",
    testid: "kept-dialog",
    build: (states) => states.map(about),
  });
}

/** Outline, and a dot for each star, as large as its arms. */
function draw(canvas, { outline_mm: outline, at_mm: places, sizes_mm: sizes }) {
  const ratio = devicePixelRatio || 1;
  [canvas.width, canvas.height] = [WIDTH_PX * ratio, HEIGHT_PX * ratio];
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const { size, centre } = bounds(outline);
  const scale = Math.min((WIDTH_PX - 2 * MARGIN_PX) / size[0], (HEIGHT_PX - 2 * MARGIN_PX) / size[1]);
  const at = ([x, y]) => [WIDTH_PX / 2 + scale * (x - centre[0]), HEIGHT_PX / 2 - scale * (y - centre[1])];
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  context.strokeStyle = context.fillStyle = ink;
  context.beginPath();
  outline.forEach((corner) => context.lineTo(...at(corner)));
  context.closePath();
  context.stroke();
  places.forEach((place, k) => {
    const length = Array.isArray(sizes[k]) ? sizes[k][0] : sizes[k];
    context.beginPath();
    context.arc(...at(place), Math.max(0.3, 0.42 * scale * length), 0, 2 * Math.PI);
    context.globalAlpha = 0.65;
    context.fill();
    context.globalAlpha = 1;
  });
}
