// What the modes of the brush do, for stars and for rods. The server knows them, too: its field of rods has the result
// (`painted_field.py`).

import { fixed } from "./format.js";

/**
 * `says` in the panel; `ring({target, amount}, digits)`, what the ring says; `to(old, value, mean)`, the size that the
 * brush draws a size to. A mode without it does all or nothing. `number`, of a mode that has one of its own: its `key`
 * in the brush, its field in the panel with `limits(range, step)` in the range of the sizes, `start(middle, step)`, its
 * value for sizes around a middle one, and `alt(number)`, what it is while Alt is held.
 */
export const MODES = {
  set: {
    text: "Set",
    title: "Set to a value",
    says: "Draws the sizes under the brush towards the target.",
    number: {
      key: "target",
      label: "Target",
      step: 0.1,
      limits: (range) => range,
      start: (middle, step) => Math.round(middle / step) * step,
    },
    ring: ({ target }, digits) => `${fixed(target, digits)} mm`,
    to: (old, value) => value,
  },
  add: {
    text: "Add",
    title: "Add or subtract",
    says: "Makes the sizes under the brush larger. Alt, or a negative amount, makes them smaller.",
    number: {
      key: "amount",
      label: "Amount",
      step: 0.05,
      limits: (_, step) => [-10 * step, 10 * step],
      start: (_, step) => 2 * step,
      alt: (amount) => -amount,
    },
    ring: ({ amount }, digits) => `${amount < 0 ? "−" : "+"}${fixed(Math.abs(amount), digits)} mm`,
    to: (old, value) => old + value,
  },
  smooth: {
    text: "Smooth",
    title: "Smooth",
    says: "Draws every size towards the mean around it.",
    to: (old, value, mean) => mean(),
  },
  erase: {
    text: "Erase",
    title: "Erase painted sizes",
    says: "Drops painted sizes: the stars get those of the tool Sizes again.",
  },
  remove: {
    text: "Remove",
    title: "Remove or restore stars",
    says: "Removes the stars under the brush. Hold Alt to bring them back.",
  },
};

/** The modes that have a number of their own, and these numbers. */
export const numbers = () => Object.entries(MODES).flatMap(([mode, { number }]) => (number ? [[mode, number]] : []));

/** The numbers of all modes by their keys, for sizes in steps around a middle one. */
export const startNumbers = (middle, step) =>
  Object.fromEntries(numbers().map(([, { key, start }]) => [key, start(middle, step)]));

/** Whether a mode does all or nothing: it has no strength. */
export const isEven = (mode) => !MODES[mode]?.to;

/** The size after the brush went a share of its way; `mean()`: of the sizes around. */
export const painted = (mode, old, share, value, mean) => old + share * (MODES[mode].to(old, value, mean) - old);
