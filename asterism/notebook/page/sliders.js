// The sliders of a preview: each change asks Python for the shape.

import { button, choice, h } from "../../studio/page/dom.js";
import { fixed } from "../../studio/page/format.js";

export class Sliders {
  #rows = new Map();
  #held = null; // the slider under the pointer: answers do not move it

  constructor(model, flow, onLate) {
    this.model = model;
    this.flow = flow;
    this.onLate = onLate;
    const { sliders, values } = model.get("panel");
    this.values = { ...values };
    this.element = h("div", { class: "sliders", hidden: sliders.length === 0 }, sliders.map((slider) => this.#row(slider)));
    if (sliders.length)
      this.element.append(
        h("div", { class: "field" }, button({ text: "Reset", testid: "reset", onclick: () => this.#reset(sliders) })),
      );
  }

  #row(slider) {
    const text = h("output", {});
    let control;
    if (slider.options.length) {
      const options = slider.options.map((value) => ({ value: String(value), text: fixed(value, slider.digits) }));
      const list = choice({
        label: slider.label,
        testid: slider.key,
        options,
        value: String(slider.start),
        onchange: (value) => this.#set(slider, Number(value), false),
      });
      control = list.element;
    } else {
      control = h("input", {
        type: "range",
        min: slider.low,
        max: slider.high,
        step: slider.step,
        value: slider.start,
        testid: slider.key,
        "aria-label": slider.label,
        oninput: () => {
          this.#held = slider.key;
          this.#set(slider, Number(control.value), true);
        },
        onchange: () => {
          this.#held = null;
          this.#set(slider, Number(control.value), false);
        },
      });
      // a notebook has keys of its own
      control.addEventListener("keydown", (event) => event.stopPropagation());
    }
    this.#rows.set(slider.key, { slider, control, text });
    return h("div", { class: "field" }, h("label", {}, slider.label), slider.options.length ? null : text, control);
  }

  #set({ key }, value, isDragging) {
    this.values[key] = value;
    this.#label(key);
    this.flow.ask({ ...this.values }, isDragging, this.onLate);
  }

  #reset(sliders) {
    this.values = Object.fromEntries(sliders.map(({ key, start }) => [key, start]));
    this.flow.ask({ ...this.values }, false, this.onLate);
    this.#place();
  }

  /** Shows the values that were answered, if none waits: another picture of this widget may have changed them. */
  show() {
    if (!this.flow.isWaiting && this.#held === null) this.values = { ...this.model.get("panel").values };
    this.#place();
  }

  #place() {
    for (const [key, { control }] of this.#rows) {
      if (key !== this.#held) control.value = String(this.values[key]);
      this.#label(key);
    }
  }

  #label(key) {
    const { slider, control, text } = this.#rows.get(key);
    const value = this.values[key];
    const [low, high] = (slider.base ?? [1, 1]).map((size) => fixed(size * value, slider.digits));
    text.textContent = slider.base
      ? `${low === high ? low : `${low} to ${high}`} ${slider.unit}`
      : `${slider.unit} ${fixed(value, slider.digits)}`;
    control.setAttribute("aria-valuetext", text.textContent);
  }
}
