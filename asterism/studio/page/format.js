// Numbers as people read them: always with a unit, always the same number of digits.

export const QUANTITIES = {
  length: { key: "length_mm", name: "Length", column: 0, step: 0.5, digits: 1, usual: 20, more: "longer", less: "shorter" },
  thickness: {
    key: "thickness_mm",
    name: "Thickness",
    column: 1,
    step: 0.05,
    digits: 2,
    usual: 1.2,
    more: "thicker",
    less: "thinner",
  },
  width: { key: "width_mm", name: "Width", column: 2, step: 0.1, digits: 2, usual: 4, more: "wider", less: "narrower" },
};

export function fixed(value, digits = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

export const mm = (value, digits = 1) => `${fixed(value, digits)} mm`;

/** A weight, as a factor. */
export const times = (value) => `×${Number(value.toFixed(value < 10 ? 1 : 0)) || value}`;

export const percent = (value, digits = 1) => `${fixed(value, digits)} %`;

export const size = (values, digits = 0) => `${values.map((value) => fixed(value, digits)).join(" × ")} mm`;

export function seconds(value) {
  if (!Number.isFinite(value)) return "–";
  if (value < 60) return `${fixed(value, value < 10 ? 1 : 0)} s`;
  return `${Math.floor(value / 60)} min ${String(Math.round(value % 60)).padStart(2, "0")} s`;
}

export function bytes(value) {
  if (!Number.isFinite(value)) return "";
  return value < 1e6 ? `${Math.max(1, Math.round(value / 1e3))} kB` : `${fixed(value / 1e6, 1)} MB`;
}

export const plural = (count, word, words = `${word}s`) => `${count} ${count === 1 ? word : words}`;

export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A field of the design file without the numbers of its entries: `pins[0].scale` is `pins.scale`. */
export const plainField = (field) => field.replace(/\[\d+\]/g, "");

/** How sure a preview is, in words, from its estimated rms distance to the exact shape in percent of the diameter. */
export function trust(expected) {
  if (!Number.isFinite(expected)) return { words: "Not estimated yet", level: 0 };
  if (expected < 1) return { words: "Very close to the exact shape", level: 3 };
  if (expected < 2.5) return { words: "Good for design decisions", level: 2 };
  if (expected < 6) return { words: "Shows the form; verify before you print", level: 1 };
  return { words: "Rough; verify before you rely on it", level: 1 };
}

export function round(value, step) {
  return Number((Math.round(value / step) * step).toFixed(6));
}
