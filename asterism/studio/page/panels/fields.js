// Number fields with unit, slider and limits, each with a line of fault; contents that are built anew around them.

import { mistakeOf, numberOf } from "../format.js";
import { h, live, replace } from "../dom.js";

/** A cell of a table of numbers in mm; what is refused is marked, and its title says why. */
export function numberCell({ limits = () => undefined, onchange, ...rest }) {
  const input = h("input.text.cell", rest);
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

/** Shows a line of fault, and marks what it is about; without a message it goes. */
export function showFault(line, message, marked, mark) {
  line.hidden = !message;
  line.textContent = message ?? "";
  marked.classList.toggle(mark, Boolean(message));
}

let count = 0;

const refused = new Set(); // of each field whose text is no value of its own, what makes it forget that

/** Fields show the numbers of the design again, whatever was typed into them: another design is shown. */
export const forgetRefused = () => refused.forEach((forget) => forget());

/**
 * A number with its unit. `onchange(value, isFinal)`: while a slider is dragged isFinal is false. `value`, `limits`
 * (a function for [min, max]), `placeholder`, `disabled` and `hidden` may follow the state.
 * Returns {element, input, set(value)}.
 */
export function numberField({
  label,
  unit = "mm",
  value = null,
  min = -Infinity,
  max = Infinity,
  limits: limitsNow,
  step = 1,
  digits = Math.max(0, -Math.floor(Math.log10(step))),
  slider = false,
  whole = false,
  disabled,
  placeholder,
  hidden,
  onchange,
  testid,
  field,
}) {
  const id = `field-${(count += 1)}`;
  let limits = [min, max];
  let present = null;
  let entered = null; // text that Enter has accepted: the change that the browser reports then is no other one
  const text = (number) => (number === null || number === undefined ? "" : String(Number(number.toFixed(digits))));
  const typing = { type: "text", inputmode: "decimal", autocomplete: "off" };
  const input = h("input", { id, ...typing, testid, disabled, placeholder, "aria-describedby": `${id}-fault` });
  const fault = h("div.fault", { id: `${id}-fault`, hidden: true, role: "alert" });
  const range = slider ? h("input", { type: "range", min, max, step, "aria-label": `${label}, ${unit}` }) : null;
  const number = h("span.number", input, h("span.unit", { "aria-hidden": "true" }, unit));
  const name = h("label", { htmlFor: id }, label);
  const element = h("div.field", { hidden, "data-field": field }, name, number, range, fault);

  function show(message) {
    showFault(fault, message, element, "bad");
    input.setAttribute("aria-invalid", String(Boolean(message)));
    if (message) refused.add(forget);
    else refused.delete(forget);
  }
  function forget() {
    input.value = text(present);
    show(null);
  }
  /** Writes a number into the field and the slider. */
  function write(number, isTyping = false) {
    present = number;
    if (!isTyping) input.value = text(number);
    if (range) range.value = number;
  }
  /** Shows a number that comes from elsewhere; what is typed right now stays, with its caret. */
  function set(number) {
    write(number, document.activeElement === input);
    show(null);
  }
  const mistake = () => mistakeOf(input.value, { unit, limits, whole });
  function accept() {
    const number = numberOf(input.value, unit);
    const message = mistake();
    show(message);
    if (message) return;
    input.value = text(number); // of a sum or another unit
    if (number === present) return;
    write(number);
    onchange(number, true);
  }
  // a fault goes while the value is typed: if it went with the focus, a button below would move away under its click
  input.addEventListener("input", () => {
    entered = null;
    if (!fault.hidden && !mistake()) show(null);
  });
  input.addEventListener("change", () => input.value === entered || accept());
  input.addEventListener("blur", () => element.classList.contains("bad") || (input.value = text(present)));
  input.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter") {
      accept();
      entered = input.value;
    }
    if (event.key === "Escape") {
      forget();
      input.blur();
    }
    const up = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!up) return;
    event.preventDefault();
    const next = Math.min(Math.max((present ?? 0) + up * step * (event.shiftKey ? 10 : 1), limits[0]), limits[1]);
    input.value = text(next);
    accept();
  });
  range?.addEventListener("input", () => {
    write(Number(range.value));
    show(null);
    onchange(present, false);
  });
  range?.addEventListener("change", () => onchange(Number(range.value), true));
  live(element, () => {
    if (limitsNow) limits = limitsNow();
    if (limitsNow && range) [range.min, range.max] = limits;
    if (typeof value !== "function") return;
    const now = value();
    // what was refused stays, with its fault, until the number is another one
    if (now !== present || !element.classList.contains("bad")) set(now);
  });
  if (typeof value !== "function") set(value);
  return { element, input, set };
}

// fields in which something is typed that is not accepted yet
addEventListener("input", ({ target }) => target.dataset && (target.dataset.typed = "true"), true);
addEventListener("change", ({ target }) => delete target.dataset?.typed, true);

/**
 * Replaces the content when the keyboard has moved on: a field that is left by Tab changes before the next one has the
 * focus. That one keeps the focus and what is typed in it; elements are the same if they have the same testid.
 */
export function rebuild(element, build) {
  setTimeout(() => {
    const before = element.contains(document.activeElement) ? document.activeElement : null;
    replace(element, build());
    const after = before?.dataset.testid && element.querySelector(`[data-testid="${before.dataset.testid}"]`);
    if (!after) return;
    after.focus();
    if (!before.dataset.typed) return void after.select?.();
    after.value = before.value;
    after.dataset.typed = "true";
    after.setSelectionRange(before.selectionStart, before.selectionEnd);
    // a browser reports a change only of what was typed into this very element
    const leave = () => after.dataset.typed && after.dispatchEvent(new Event("change", { bubbles: true }));
    after.addEventListener("blur", leave, { capture: true, once: true });
  });
}
