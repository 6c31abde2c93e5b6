// Earlier states of the design as small plans; one click shows one of them.

import { button, dialog, h, hint, refresh } from "../dom.js";
import { date } from "../format.js";
import { bounds } from "../geometry.js";

const WIDTH_PX = 144;
const HEIGHT_PX = 108;
const MARGIN_PX = 8;

export function openHistory({ store, connection }) {
  const list = h("div", { class: "thumbnails" });
  const update = () => {
    const states = [...(store.get("history") ?? [])].reverse();
    refresh(list, states, () => (states.length ? states.map(thumbnail) : hint("There are no earlier states yet.")));
  };

  function thumbnail(state) {
    const picture = h("canvas", { "aria-hidden": "true" });
    draw(picture, state);
    return h(
      "button",
      {
        type: "button",
        class: "thumbnail",
        "aria-current": String(Boolean(state.is_shown)),
        testid: `state-${state.position}`,
        onclick: () => (store.set({ hole: null }), connection.send("go", { position: state.position })),
      },
      picture,
      h("span", { title: state.words }, state.words),
    );
  }

  const stops = [store.on(["history"], update), store.on(["document"], () => connection.send("history"))];
  dialog("Earlier states", [hint("The newest is first. Undo and redo go through the same states."), list], {
    testid: "history-dialog",
    onclose: () => stops.forEach((stop) => stop()),
  });
  connection.send("history");
  update();
}

/** The unsaved work of other sessions, each to be brought back or forgotten. */
export function openKept({ store, connection }) {
  const list = h("div", { class: "thumbnails" });
  const about = (state) => {
    const picture = h("canvas", { "aria-hidden": "true" });
    if (state.outline_mm) draw(picture, state);
    const ask = (type) => () => connection.send(type, { name: state.name });
    return h(
      "div",
      { class: "thumbnail", testid: `kept-${state.name}` },
      picture,
      h("span", {}, date(state.time)),
      button({ text: "Bring it back", onclick: ask("recover") }),
      button({ text: "Forget it", onclick: ask("discard") }),
    );
  };
  const update = () => refresh(list, store.get("kept"), () => (store.get("kept") ?? []).map(about));
  const stops = [store.on(["kept"], update), store.on(["document"], () => connection.send("kept"))];
  dialog("Unsaved changes of earlier sessions", [hint("The newest is first."), list], {
    testid: "kept-dialog",
    onclose: () => stops.forEach((stop) => stop()),
  });
  connection.send("kept");
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
