// Panel of the brush.

import { MODES, isEven, numbers, startNumbers } from "../brush_modes.js";
import { bound, check, follow, h, hint, section, segments } from "../dom.js";
import { QUANTITIES, QUANTITY_NAMES } from "../format.js";
import { clamp } from "../geometry.js";
import { RADII, brushOn, namesWithOwn } from "../sheet.js";
import { numberField } from "./fields.js";

/** Unit and factor of the numbers that both brushes have. */
const COMMON = {
  radius: { step: 0.5, min: RADII[0], max: RADII[1] },
  strength: { unit: "%", min: 1, max: 100, step: 1, factor: 100 },
};

/**
 * What the panels of both brushes have: `change(patch)` of its `setting` in the store, `mode`, what it `says`, and
 * `field(label, key, options)`, a number of the brush.
 */
export function brushParts({ store }, { setting, modes, prefix = "" }) {
  const brush = () => brushOn(store.get("sheet"), store.get(setting));
  const change = (patch) => store.set({ [setting]: { ...store.get(setting), ...patch } });
  const options = { label: "Brush mode", testid: `${prefix}mode`, options: modes };
  const mode = segments({ ...options, ...bound(store, setting, "mode") });
  const field = (label, key, more = {}) => {
    const { factor = 1, ...rest } = { ...COMMON[key], ...more };
    const value = () => Number((factor * brush()[key]).toFixed(4));
    const onchange = (typed) => change({ [key]: typed / factor });
    return numberField({ label, slider: true, testid: prefix + key, value, onchange, ...rest });
  };
  return { brush, change, mode, says: hint(() => modes[brush().mode].says), field };
}

export function brushPanel(studio, { on }) {
  const { store } = studio;
  const sheet = () => store.get("sheet");
  const isOfRods = () => Boolean(sheet()?.isOfRods);
  const modes = { ...MODES };
  for (const name of Object.keys(MODES).filter(isEven)) modes[name] = { ...MODES[name], hidden: isOfRods };
  const { brush, change, mode, says, field } = brushParts(studio, { setting: "brush", modes });
  const hasNoSize = () => isEven(brush().mode);
  /** What the brush may paint; sliders of rods end at usual sizes. */
  const range = () => sheet()?.range(brush().quantity, store.get("inLaw")) ?? [0, 20];
  const shown = () => [range()[0], isOfRods() ? Math.min(range()[1], QUANTITIES[brush().quantity].usual) : range()[1]];
  function rangeText() {
    const printable = sheet()?.printable(brush().quantity);
    const kind = store.get("inLaw") && !isOfRods() ? "Calibrated" : "Allowed";
    const said = `${kind}: ${range().map(plainly).join(" to ")} mm.`;
    return printable ? `${said} Printable: steps of ${plainly(printable.step)} mm.` : said;
  }
  const length = { text: QUANTITY_NAMES.length, hidden: isOfRods };
  const name = () => QUANTITIES[brush().quantity].name.toLowerCase();
  const own = () => isOfRods() && namesWithOwn(sheet().design, QUANTITIES[brush().quantity].key).size > 0;
  return [
    follow(on, ["brush", "inLaw", "sheet"], [
      mode,
      says,
      segments({
        label: "Size to paint",
        testid: "quantity",
        options: { ...QUANTITY_NAMES, length },
        value: () => brush().quantity,
        onchange: (value) => change(valuesFor(sheet(), value)),
        hidden: hasNoSize,
      }),
      numbers().map(([of, number]) => {
        const limits = () => number.limits(shown(), QUANTITIES[brush().quantity].step);
        const now = { limits, value: () => clamp(brush()[number.key], ...limits()), hidden: () => brush().mode !== of };
        return field(number.label, number.key, { digits: 2, ...number, ...now });
      }),
      field("Radius", "radius"),
      field("Strength", "strength", { hidden: hasNoSize }),
      check({
        text: "Stay within the calibrated range",
        testid: "in-law",
        ...bound(store, "inLaw"),
        hidden: () => hasNoSize() || isOfRods(), // cells of rods are solved for the sizes that are painted
      }),
      hint(rangeText, { hidden: hasNoSize }),
    ]),
    // not at each dab
    follow(on, ["brush", "document"], [
      hint(() => `Lines with a ${name()} of their own keep it. The tool Sizes changes it.`, {
        hidden: () => !own(),
      }),
    ]),
    symmetry(studio, { on }),
  ];
}

/** What the brush paints with at first: the middle of the sizes that the sheet has. */
function valuesFor(sheet, quantity) {
  const { step } = QUANTITIES[quantity];
  const [low, high] = sheet?.range(quantity, true) ?? [0, 10];
  const present = sheet?.values(quantity).sort((a, b) => a - b);
  const value = present?.length ? present[present.length >> 1] : (low + high) / 2;
  return { quantity, ...startNumbers(value, step) };
}

/** Rods are drawn: they have no lengths, and the brush does not erase or remove them. */
export function fitBrushToRods(store) {
  const brush = store.get("brush");
  if (brush.quantity === "length") {
    const { target, amount } = valuesFor(store.get("sheet"), "thickness");
    store.set({ brush: { ...brush, quantity: "thickness", mode: "set", target: target + amount, amount } });
  } else if (isEven(brush.mode)) store.set({ brush: { ...brush, mode: "set" } });
}

/** Mirrors and sixfold symmetry while painting. */
export function symmetry({ store }, { on }) {
  const names = { mirrorX: "Left–right", mirrorY: "Top–bottom", sixfold: "Sixfold" };
  const box = ([key, text]) => check({ text, testid: key, ...bound(store, "symmetry", key) });
  const boxes = Object.entries(names).map(box);
  return [section("Symmetry"), h("div.row.wrap", follow(on, ["symmetry"], boxes))];
}

const plainly = (value) => String(Number(value.toFixed(3)));
