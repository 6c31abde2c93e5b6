// Shapes that the server keeps: small pictures of them, and one of them beside the shown shape, with the same camera.

import { unpack } from "../connection.js";
import { listenToView } from "./pointer.js";
import { View } from "./view.js";

const PICTURE_PX = [84, 63];
const MAX_PICTURES = 60;
const FRAMES = { mesh: 1, shape: 2 };
// what the second view does not share with the page
const OWN = {
  shown: "shape",
  badge: null,
  hover: null,
  under: new Set(),
  selection: new Set(),
  showTarget: false,
  paintOnSheet: false,
  tool: "select",
};

export class KeptShapes {
  #pictures = new Map(); // addresses of small pictures, by number or by what the shown shape is
  #beside = null; // the shape beside the shown one
  #drawing = Promise.resolve();

  constructor(canvas, store, view) {
    const shared = { get: (key) => (key in OWN ? OWN[key] : store.get(key)), set() {}, on: (...args) => store.on(...args) };
    Object.assign(this, { canvas, store, main: view });
    this.view = new View(canvas, shared, { onFrame: () => {}, legend: document.createElement("div"), leader: view });
    listenToView(this.view, { store: shared });
    store.on(["beside"], ({ beside }) => this.#show(beside));
  }

  #take(shape) {
    for (const kind of Object.values(FRAMES))
      this.view.take({ kind, header: { ...shape.header, mesh: 0 }, arrays: shape.arrays });
  }

  /** Address of a small picture of the shape of a number, or of the shown one, which `key` tells from those before. */
  picture(number, key = number) {
    if (!this.#pictures.has(key)) this.#pictures.set(key, this.#drawn(number));
    for (const old of [...this.#pictures.keys()].slice(0, -MAX_PICTURES)) this.#pictures.delete(old);
    return this.#pictures.get(key);
  }

  async #drawn(number) {
    const { header, mesh, ...arrays } = this.main.shape;
    const shape = number === null ? { header, arrays: { ...mesh, ...arrays, before: undefined } } : await fetched(number);
    await (this.#drawing = this.#drawing.then(() => new Promise(requestAnimationFrame))); // one in each frame
    this.#take(shape);
    const [width, height] = PICTURE_PX.map((side) => side * Math.min(devicePixelRatio || 1, 2));
    const drawn = this.view.picture(width, height, { isSmall: true });
    if (this.#beside) {
      this.#take(this.#beside);
      this.view.draw(0.5); // its canvas does not show the small picture
    }
    return URL.createObjectURL(await drawn);
  }

  async #show(beside) {
    const shape = beside && (await fetched(beside.shape).catch(() => null));
    if (this.store.get("beside") !== beside) return;
    if (beside && !shape) return this.store.set({ beside: null }); // it is gone
    this.#beside = shape;
    this.canvas.hidden = !shape;
    this.canvas.parentElement.classList.toggle("two", Boolean(shape));
    [this.main.partner, this.view.partner] = shape ? [this.view, this.main] : [null, null];
    if (shape) this.#take(shape);
    requestAnimationFrame(() => this.main.fit());
  }
}

async function fetched(number) {
  const answer = await fetch(`shape/${number}`);
  if (!answer.ok) throw new Error(String(answer.status));
  return unpack(await answer.arrayBuffer());
}
