// The state of the page: what the server said, what is selected, which tool is active. Everything else reads it here.

import { badgeOf } from "./badge.js";
import { startNumbers } from "./brush_modes.js";

/** Values by name; listeners are called after a change with the new values. */
export class Store {
  #values;
  #listeners = new Map();

  constructor(values) {
    this.#values = values;
  }

  get(key) {
    return this.#values[key];
  }

  /** Sets values and tells the listeners of those that changed. */
  set(patch) {
    const changed = Object.keys(patch).filter((key) => this.#values[key] !== patch[key]);
    Object.assign(this.#values, patch);
    const called = new Set();
    for (const key of changed) {
      for (const listener of [...(this.#listeners.get(key) ?? [])]) {
        if (!called.has(listener)) {
          called.add(listener);
          listener(this.#values);
        }
      }
    }
  }

  /** Calls `listener` at changes of any of the keys; returns a function that stops it. */
  on = (keys, listener) => {
    for (const key of keys) {
      if (!this.#listeners.has(key)) this.#listeners.set(key, new Set());
      this.#listeners.get(key).add(listener);
    }
    return () => keys.forEach((key) => this.#listeners.get(key).delete(listener));
  };
}

/** What a page remembers from visit to visit. */
const SETTINGS = {
  brush: { quantity: "length", mode: "set", radius: null, strength: 0.5, ...startNumbers(9, 0.5) },
  weightBrush: { mode: "paint", radius: null, strength: 0.5, weight: 5 }, // radii: null follows the sheet, see sheet.js
  inLaw: true,
  snap: true,
  grid: true,
  planColour: "none",
  viewColour: "none",
  showArms: true,
  showBumps: true,
  showTarget: true,
  orthographic: false,
  theme: "auto",
  planShare: 50,
};

/** What is said, chosen, found and begun for a design, before anything is. */
export const ofDesign = () => ({
  frame: null, // header of the shape that is drawn
  beside: null, // a kept shape beside the shown one: {shape, name}
  results: {}, // results by job
  history: null, // earlier states, as the server listed them
  kept: null, // unsaved work of other sessions, as the server listed it
  problem: null,
  selection: new Set(),
  selecting: "new", // what a click or a lasso does with the stars: new | more | less
  hover: null,
  under: new Set(), // stars under a brush on the sheet in space
  cursor: null, // star of the keyboard
  support: null, // selected needle: {table, point}
  corner: null, // selected corner of the outline
  hole: null, // selected hole
  measured: null, // by the ruler
  sizesOf: "", // path of the rods that get sizes; "" for stars or all rods
  symmetry: { mirrorX: false, mirrorY: false, sixfold: false },
});

const MEMORY = "asterism-studio";

function remembered() {
  try {
    return JSON.parse(localStorage.getItem(MEMORY) ?? "{}");
  } catch {
    return {};
  }
}

export function createStore() {
  const store = new Store({
    connection: "connecting", // connecting | open | lost
    document: null,
    sheet: null, // the document's plan with the sizes that are being painted, see sheet.js
    state: { engine: "starting", numbers: {}, warnings: [], forms: [], slots: {} },
    gallery: null,
    startOpen: false,
    badge: { kind: "computing", words: "Connecting" }, // the state of the shape, see badge.js
    jobs: {}, // progress by job
    tool: "brush",
    page: "tool", // tool | sheet | shape
    printArea: false,
    copied: null, // sizes of a star, by quantity
    paintOnSheet: false, // whether a drag on the sheet in space paints
    sizesKind: "radial", // how sizes run over the sheet
    shown: "shape", // shape | preview | distance: the last two beside an exact shape
    ...ofDesign(),
    ...SETTINGS,
    ...settings(remembered()),
  });
  store.on(["state", "frame", "connection", "document"], (values) => {
    const badge = badgeOf(values);
    if (JSON.stringify(badge) !== JSON.stringify(values.badge)) store.set({ badge });
  });
  store.on(Object.keys(SETTINGS), (values) => {
    try {
      localStorage.setItem(MEMORY, JSON.stringify(settings(values)));
    } catch {
      // a browser without storage forgets the settings
    }
  });
  return store;
}

/** The settings among some values; another version of the page may have kept them in another form. */
function settings(values) {
  const known = Object.entries(SETTINGS).filter(([key, usual]) => typeof values[key] === typeof usual);
  const whole = (usual, value) => (typeof usual === "object" ? { ...usual, ...value } : value);
  return Object.fromEntries(known.map(([key, usual]) => [key, whole(usual, values[key])]));
}
