// The sheet in a notebook: the studio's view in a frame of its own, with sliders for a preview.

import { unpack } from "../../studio/page/connection.js";
import { button, check, choice, h, replace } from "../../studio/page/dom.js";
import { Store } from "../../studio/page/store.js";
import { VIEWS } from "../../studio/page/view/camera.js";
import { FIELDS } from "../../studio/page/view/colours.js";
import { listenToView, turnByKey } from "../../studio/page/view/pointer.js";
import { View } from "../../studio/page/view/view.js";
import { Flow } from "./flow.js";
import { Sliders } from "./sliders.js";
import colours from "../../studio/page/colours.css";
import controls from "../../studio/page/controls.css";
import overlays from "../../studio/page/dialogs.css";
import widget from "./widget.css";

const STYLE = [colours.replaceAll(":root", ":host"), controls, overlays, widget].join("\n");

/** What the view reads, as far as a notebook has it. */
const VIEW_STATE = {
  sheet: { stars: [], starAt: () => null }, // no stars to mark
  viewColour: "none",
  showArms: true,
  showBumps: true,
  orthographic: false,
  shown: "shape",
  frame: null,
  hover: null,
  under: new Set(),
  selection: new Set(),
  theme: "auto",
  connection: "open",
};

const buffer = (view) => view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength);

/** Light text stands on a dark ground, whatever the notebook's themes are called. */
function isOnDark(element) {
  const [r, g, b] = getComputedStyle(element).color.match(/[\d.]+/g).map(Number);
  return 0.299 * r + 0.587 * g + 0.114 * b > 140;
}

function listenToKeys(canvas, view) {
  canvas.addEventListener("keydown", (event) => {
    if (!turnByKey(event, view)) return;
    event.preventDefault();
    event.stopPropagation(); // the notebook has keys of its own
  });
}

function render({ model, el }, flow) {
  const host = h("div", { class: "asterism-sheet" });
  el.append(host);
  const root = host.attachShadow({ mode: "open" });
  const canvas = h("canvas", { tabindex: "0", role: "application", testid: "view" });
  canvas.setAttribute("aria-label", "The sheet in space. Arrow keys turn it, plus and minus zoom, F shows all of it.");
  const legend = h("div", { id: "legend", testid: "legend", hidden: true });
  const bar = h("div", { class: "bar" });
  const picture = h("div", { class: "picture" }, canvas, legend, bar);
  picture.style.height = `${model.get("height_px")}px`;
  // the wheel scrolls the notebook until the sheet has been clicked
  picture.addEventListener("wheel", (event) => root.activeElement !== canvas && event.stopPropagation(), true);
  const figures = h("div", { class: "figures", testid: "figures" });
  const notes = h("div", { class: "notes", testid: "notes", role: "status" });
  const store = new Store({ ...VIEW_STATE });
  const theme = () => {
    host.style.colorScheme = isOnDark(el) ? "dark" : "light";
    store.set({ theme: host.style.colorScheme });
  };
  const themes = new MutationObserver(theme);
  for (const element of [document.documentElement, document.body]) themes.observe(element, { attributes: true });
  theme();
  const sliders = new Sliders(model, flow, () => tell());
  root.append(h("style", {}, STYLE), h("div", { class: "frame" }, picture, sliders.element, figures, notes));

  let view = null;
  try {
    view = new View(canvas, store, { onFrame: () => {}, legend });
  } catch (error) {
    replace(picture, h("p", { class: "hint" }, error.message));
  }
  if (view) {
    listenToView(view, { store, edits: null });
    listenToKeys(canvas, view);
  }

  let colour = null;
  const build = () => {
    const names = Object.keys(FIELDS).filter((name) => name === "none" || name === "height" || view.shape[name]?.length);
    colour = choice({
      label: "Colour",
      testid: "colour",
      options: names.map((value) => ({ value, text: value === "none" ? "Plain sheet" : FIELDS[value].name })),
      value: store.get("viewColour"),
      onchange: (value) => store.set({ viewColour: value }),
    });
    const look = choice({
      label: "Named view",
      testid: "named-view",
      options: [{ value: "", text: "View" }, ...Object.entries(VIEWS).map(([value, { name }]) => ({ value, text: name }))],
      value: "",
      onchange: (value) => (value && view.look(value), look.set("")),
    });
    const arms = check({ text: "Arms", value: true, testid: "arms", onchange: (on) => store.set({ showArms: on }) });
    replace(
      bar,
      colour.element,
      look.element,
      view.shape.arms.length ? arms.element : null,
      button({ icon: "fit", label: "Show all of the sheet", testid: "fit", onclick: () => view.fit() }),
    );
  };

  let mesh = null;
  const draw = () => {
    if (!view || !model.get("frame")?.byteLength) return;
    if (model.get("mesh") !== mesh) {
      mesh = model.get("mesh");
      view.take(unpack(buffer(mesh)));
    }
    view.take(unpack(buffer(model.get("frame"))));
    if (!colour) build();
  };
  const tell = () => {
    const { figures: known, warnings, problem } = model.get("panel");
    replace(
      figures,
      known.map(([name, text]) => h("span", {}, h("span", { class: "name" }, name), " ", text)),
    );
    replace(
      notes,
      problem ? h("p", { class: "bad" }, `${problem} The last good shape is shown.`) : null,
      flow.isLate ? h("p", {}, "Waiting for Python: it computes, or another cell runs.") : null,
      warnings.length
        ? h("details", {}, h("summary", {}, `Warnings: ${warnings.length}`), h("ul", {}, warnings.map((text) => h("li", {}, text))))
        : null,
    );
    sliders.show();
  };
  model.on("change:frame", draw);
  model.on("change:panel", tell);
  draw();
  tell();
  host.sheet = { view, store }; // for tests and scripts
  return () => {
    model.off("change:frame", draw);
    model.off("change:panel", tell);
    themes.disconnect();
    view?.close();
  };
}

/** Called once for each widget, however often it is shown: all its pictures share one flow of requests. */
export default () => {
  let flow = null;
  return {
    initialize: ({ model }) => void (flow = new Flow(model)),
    render: (context) => render(context, (flow ??= new Flow(context.model))),
  };
};
