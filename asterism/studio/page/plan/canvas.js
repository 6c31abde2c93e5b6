// The canvas of the plan: place and size on the screen, pointers, wheel and pinch; tools get printed millimetres.

import { DARK } from "../dom.js";
import { clamp } from "../geometry.js";
import { drawPlan } from "./draw.js";
import { listenToPointers } from "../pointers.js";

const MARGIN_PX = 48;
const TOP_PX = 56; // below the bar
const BOTTOM_PX = 104; // above scale bar and legend
const MIN_SCALE = 0.2; // px per mm
const MAX_SCALE = 80;
const DRAWN =
  "sheet selection hover cursor planColour grid printArea brush weightBrush support corner hole theme symmetry tool state";

export class PlanCanvas {
  #isPressed = false;
  #isPan = false;
  #isDirty = false;
  #hasFit = false;

  constructor(canvas, store) {
    this.canvas = canvas;
    this.store = store;
    this.scale = 3;
    this.offset = [0, 0]; // screen place of the origin, px
    this.tool = null;
    this.isSpaceDown = false;
    this.pulse = null; // {at, until}: a ring that marks a place for a moment
    new ResizeObserver(() => this.#resized()).observe(canvas);
    const tell = (what) => (event) => this.tool?.[what]?.(this.#event(event));
    const end = (what) => (event) => {
      const isPan = this.#isPan;
      this.#isPressed = this.#isPan = false;
      if (!isPan) tell(what)(event);
    };
    listenToPointers(canvas, {
      down: (event) => this.#down(event),
      move: (event, step) => (this.#isPan ? this.#move(step) : tell("move")(event)),
      up: end("up"),
      cancel: end("cancel"),
      hover: tell("hover"),
      leave: tell("leave"),
      pinch: ({ factor, step, middle }) => (this.#move(step), this.zoom(factor, this.#pixel(middle))),
      wheel: (event) => this.#wheel(event),
    });
    canvas.addEventListener("dblclick", tell("double"));
    store.on(DRAWN.split(" "), () => this.invalidate());
    store.on(["printArea"], () => this.fit());
    matchMedia(DARK).addEventListener("change", () => this.invalidate());
  }

  /** Calls off what a pressed pointer does. Returns whether there is one. */
  cancel() {
    if (this.#isPressed) this.tool?.cancel?.();
    return this.#isPressed;
  }

  toScreen(point) {
    return [this.offset[0] + this.scale * point[0], this.offset[1] - this.scale * point[1]];
  }

  toPlan(pixel) {
    return [(pixel[0] - this.offset[0]) / this.scale, (this.offset[1] - pixel[1]) / this.scale];
  }

  /** Millimetres of a number of pixels. */
  px(count) {
    return count / this.scale;
  }

  fit() {
    const sheet = this.store.get("sheet");
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!sheet || !width) return;
    const { size: sheetSize, centre } = sheet.box;
    const area = this.store.get("printArea") ? (sheet.printer?.frame_mm ?? [0, 0]) : [0, 0];
    const size = sheetSize.map((value, axis) => Math.max(value, area[axis]));
    const room = [width - 2 * MARGIN_PX, height - TOP_PX - BOTTOM_PX];
    this.scale = clamp(Math.min(room[0] / size[0], room[1] / size[1]), MIN_SCALE, MAX_SCALE);
    this.offset = [width / 2 - this.scale * centre[0], TOP_PX + room[1] / 2 + 8 + this.scale * centre[1]];
    this.#hasFit = true;
    this.invalidate();
  }

  zoom(factor, around = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2]) {
    const fixed = this.toPlan(around);
    this.scale = clamp(this.scale * factor, MIN_SCALE, MAX_SCALE);
    this.offset = [around[0] - this.scale * fixed[0], around[1] + this.scale * fixed[1]];
    this.invalidate();
  }

  /** Marks a place: moves it into the picture if needed, and draws a ring for a moment. */
  show(at) {
    const [x, y] = this.toScreen(at);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (x < 40 || y < TOP_PX || x > width - 40 || y > height - 40) {
      this.offset = [this.offset[0] + width / 2 - x, this.offset[1] + height / 2 - y];
    }
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.pulse = { at, start: performance.now(), duration: 1400, still };
    this.invalidate();
  }

  invalidate() {
    if (this.#isDirty) return;
    this.#isDirty = true;
    requestAnimationFrame(() => {
      this.#isDirty = false;
      this.#draw();
    });
  }

  #draw() {
    if (!this.store.get("sheet")) return;
    if (!this.#hasFit) this.fit();
    const ratio = devicePixelRatio || 1;
    const context = this.canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawPlan(context, this);
    if (this.pulse) {
      if (performance.now() - this.pulse.start > this.pulse.duration) this.pulse = null;
      if (this.pulse?.still) setTimeout(() => this.invalidate(), this.pulse.duration);
      else this.invalidate();
    }
  }

  #resized() {
    const ratio = devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !height) return;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.fit();
  }

  #pixel([x, y]) {
    const box = this.canvas.getBoundingClientRect();
    return [x - box.left, y - box.top];
  }

  #event(event) {
    const pixel = this.#pixel([event.clientX, event.clientY]);
    const { shiftKey: shift, altKey: alt, ctrlKey, metaKey, pressure, pointerType } = event;
    return {
      at: this.toPlan(pixel),
      pixel,
      shift,
      alt,
      control: ctrlKey || metaKey,
      force: pointerType === "pen" ? pressure : 1,
      isTouch: pointerType === "touch",
    };
  }

  #down(event) {
    this.#isPressed = true;
    this.#isPan = event.button === 1 || event.button === 2 || this.isSpaceDown;
    if (!this.#isPan) this.tool?.down?.(this.#event(event));
  }

  #move([dx, dy]) {
    this.offset = [this.offset[0] + dx, this.offset[1] + dy];
    this.invalidate();
  }

  #wheel(event) {
    if (this.tool?.wheel?.(event)) return;
    this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), this.#event(event).pixel);
  }
}
