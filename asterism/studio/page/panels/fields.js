// Number fields with unit, slider and limits; each shows one line of fault.

import { mistakeOf, numberOf } from "../format.js";
import { h } from "../dom.js";

/** A cell of a table of numbers in mm; what is refused is marked, and its title says why. */
export function numberCell({ value, label, testid, limits = () => undefined, onchange }) {
  const input = h("input", { class: "text cell", value, "aria-label": label, testid });
  input.addEventListener("keydown", (event) => event.stopPropagation());
  input.addEventListener("change", () => {
    const refused = mistakeOf(input.value, { unit: "mm", limits: limits() });
    input.classList.toggle("bad-field", Boolean(refused));
    input.setAttribute("aria-invalid", String(Boolean(refused)));
    input.title = refused ?? "";
    if (!refused) onchange(numberOf(input.value, "mm"));
  });
  return input;
}

let count = 0;

/**
 * A number with its unit. `onchange(value, isFinal)`: while a slider is dragged isFinal is false.
 * Returns {element, set(value), limits(min, max), fault(text), isRefused()}.
 */
export function numberField({
  label,
  unit = "mm",
  value,
  min = -Infinity,
  max = Infinity,
  step = 1,
  digits,
  slider = false,
  whole = false,
  onchange,
  testid,
  field,
}) {
  const id = `field-${(count += 1)}`;
  const places = digits ?? Math.max(0, -Math.floor(Math.log10(step)));
  let limits = [min, max];
  let present = value;
  let entered = null; // text that Enter has accepted: the change that the browser reports then is no other one
  const text = (number) => (number === null || number === undefined ? "" : String(Number(number.toFixed(places))));
  const input = h("input", {
    id,
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    value: text(value),
    testid,
    "aria-describedby": `${id}-fault`,
  });
  const fault = h("div", { class: "fault", id: `${id}-fault`, hidden: true, role: "alert" });
  const range = slider ? h("input", { type: "range", min, max, step, value, "aria-label": `${label}, ${unit}` }) : null;
  const element = h(
    "div",
    { class: "field" },
    h("label", { for: id }, label),
    h("span", { class: "number" }, input, h("span", { class: "unit", "aria-hidden": "true" }, unit)),
    range,
    fault,
  );
  if (field) element.dataset.field = field;

  function show(message) {
    fault.hidden = !message;
    fault.textContent = message ?? "";
    element.classList.toggle("bad", Boolean(message));
    input.setAttribute("aria-invalid", String(Boolean(message)));
  }
  function set(number) {
    present = number;
    if (document.activeElement !== input) input.value = text(number);
    if (range) range.value = number;
    show(null);
  }
  const typed = () => numberOf(input.value, unit);
  const mistake = () => mistakeOf(input.value, { unit, limits, whole });
  function accept(isFinal) {
    const number = typed();
    const refused = mistake();
    show(refused);
    if (refused) return;
    input.value = text(number); // of a sum or another unit
    if (number === present) return;
    present = number;
    if (range) range.value = number;
    onchange(number, isFinal);
  }
  // a fault goes while the value is typed: if it went with the focus, a button below would move away under its click
  input.addEventListener("input", () => {
    entered = null;
    if (!fault.hidden && !mistake()) show(null);
  });
  input.addEventListener("change", () => input.value === entered || accept(true));
  input.addEventListener("blur", () => element.classList.contains("bad") || (input.value = text(present)));
  input.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter") {
      accept(true);
      entered = input.value;
    }
    if (event.key === "Escape") {
      input.value = text(present);
      show(null);
      input.blur();
    }
    const up = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!up) return;
    event.preventDefault();
    const next = Math.min(Math.max((present ?? 0) + up * step * (event.shiftKey ? 10 : 1), limits[0]), limits[1]);
    input.value = text(next);
    accept(true);
  });
  if (range) {
    range.addEventListener(
      "input",
      () => ((present = Number(range.value)), (input.value = text(present)), show(null), onchange(present, false)),
    );
    range.addEventListener("change", () => onchange(Number(range.value), true));
  }
  return {
    element,
    input,
    set,
    fault: show,
    /** Whether the text is no value of the field; then the field says so and has the focus. */
    isRefused() {
      const refused = mistake();
      if (refused) {
        show(refused);
        input.focus();
      }
      return Boolean(refused);
    },
    limits(low, high) {
      limits = [low, high];
      if (range) Object.assign(range, { min: low, max: high });
    },
  };
}
