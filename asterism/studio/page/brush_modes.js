// What the modes of the brush do, for stars and for rods. The server knows them, too: its field of rods has the result.

import { fixed } from "./format.js";

/**
 * `says` in the panel; `ring({target, amount}, digits)`, what the ring says; `to(old, value, mean)`, the size that the
 * brush draws a size to. A mode without it does all or nothing.
 */
export const MODES = {
  set: {
    text: "Set",
    title: "Set to a value",
    says: "Draws the sizes under the brush towards the target.",
    ring: ({ target }, digits) => `${fixed(target, digits)} mm`,
    to: (old, value) => value,
  },
  add: {
    text: "Add",
    title: "Add or subtract",
    says: "Makes the sizes under the brush larger. Alt, or a negative amount, makes them smaller.",
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

/** Whether a mode does all or nothing: it has no strength. */
export const isEven = (mode) => !MODES[mode]?.to;

/** The size after the brush went a share of its way; `mean()`: of the sizes around. */
export const painted = (mode, old, share, value, mean) => old + share * (MODES[mode].to(old, value, mean) - old);
