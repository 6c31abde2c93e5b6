// Numbers as people read them: always with a unit, always the same number of digits.

/** The sizes of stars by their names on the server: `column` in its order, `usual`, where sliders for rods end, and
 * what a star of a size is. */
export const QUANTITIES = {
  length: { key: "length_mm", name: "Length", column: 0, step: 0.5, digits: 1, usual: 20, is: "long" },
  thickness: { key: "thickness_mm", name: "Thickness", column: 1, step: 0.05, digits: 2, usual: 1.2, is: "thick" },
  width: { key: "width_mm", name: "Width", column: 2, step: 0.1, digits: 2, usual: 4, is: "wide" },
};

/** Their names, as options of a list. */
export const QUANTITY_NAMES = Object.fromEntries(Object.entries(QUANTITIES).map(([value, { name }]) => [value, name]));

export function fixed(value, digits = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

export const mm = (value, digits = 1) => `${fixed(value, digits)} mm`;

/** The sizes of a star: what `words` says of each quantity and its size. */
export const sizesOf = ({ sizes }, words) =>
  Object.values(QUANTITIES).map((entry) => words(entry, mm(sizes[entry.column], entry.digits))).join(", ");

/** A weight, as a factor. */
export const times = (value) => `×${Number(value.toFixed(value < 10 ? 1 : 0)) || value}`;

export const percent = (value, digits = 1) => `${fixed(value, digits)} %`;

export const size = (values, digits = 0) => `${values.map((value) => fixed(value, digits)).join(" × ")} mm`;

export function seconds(value, digits = value < 10 ? 1 : 0) {
  if (!Number.isFinite(value)) return "–";
  if (value < 60) return `${fixed(value, digits)} s`;
  return `${Math.floor(value / 60)} min ${String(Math.round(value % 60)).padStart(2, "0")} s`;
}

export function bytes(value) {
  if (!Number.isFinite(value)) return "";
  return value < 1e6 ? `${Math.max(1, Math.round(value / 1e3))} kB` : `${fixed(value / 1e6, 1)} MB`;
}

export const plural = (count, word, words = `${word}s`) => `${count} ${count === 1 ? word : words}`;

/** A time in s since 1970, as the browser's language writes it. */
export const date = (time) => new Date(1000 * time).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });

export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A field of the design file without the numbers of its entries: `pins[0].scale` is `pins.scale`. */
export const plainField = (field) => field.replace(/\[\d+\]/g, "");

const UNITS_MM = { mm: 1, cm: 10, m: 1000, in: 25.4 };

/** The number of a text, as people type it: with a comma or a point, in another unit of length, as a sum such as
 * 2*7,5+1; NaN if it is none. */
export function numberOf(text, unit = "") {
  const plain = text.trim().replaceAll("−", "-").replaceAll("×", "*").replaceAll(",", ".").toLowerCase();
  const tokens = plain.match(/(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|[a-z%]+|\S/g) ?? [];
  let k = 0;
  const atom = () => {
    const token = tokens[k++];
    if (token === "-" || token === "+") return token === "-" ? -atom() : atom();
    if (token === "(") {
      const value = sum();
      return tokens[k++] === ")" ? value : NaN;
    }
    const factor = unit === "mm" ? UNITS_MM[tokens[k]] : tokens[k] === unit && unit ? 1 : undefined;
    if (factor) k += 1;
    return /^[\d.]/.test(token ?? "") ? Number(token) * (factor ?? 1) : NaN;
  };
  const row = (part, operators) => () => {
    let value = part();
    while (operators[tokens[k]]) value = operators[tokens[k++]](value, part());
    return value;
  };
  const product = row(atom, { "*": (a, b) => a * b, "/": (a, b) => a / b });
  const sum = row(product, { "+": (a, b) => a + b, "-": (a, b) => a - b });
  const value = sum();
  return k === tokens.length && Number.isFinite(value) ? value : NaN;
}

/** Why a text is no value of a field from `low` to `high`; null if it is one. */
export function mistakeOf(text, { unit = "", limits: [low, high] = [-Infinity, Infinity], whole = false } = {}) {
  const number = numberOf(text, unit);
  if (!Number.isFinite(number)) return "A number, please";
  const said = (value) => `${Number(value.toFixed(3))} ${unit}`.trim();
  if (number < low || number > high) {
    if (low === -Infinity) return `At most ${said(high)}`;
    return high === Infinity ? `At least ${said(low)}` : `From ${said(low)} to ${said(high)}`;
  }
  return whole && !Number.isInteger(number) ? "A whole number, please" : null;
}

/** A message without the parts that name options of the command line, which a page does not have. */
export const withoutOptions = (text) =>
  text
    .replace(/^--[a-z-]+:? /, "")
    .replace(/\s*\([^()]*--[a-z][^()]*\)/g, "")
    .replace(/\s*[;,:][^;,:]*\s--[a-z][^;,:]*/g, "");
