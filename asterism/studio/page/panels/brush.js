// Panel of the brush.

import { check, h, hint, section, segments } from "../dom.js";
import { QUANTITIES, QUANTITY_NAMES } from "../format.js";
import { RADII, brushOn, namesWithOwn } from "../sheet.js";
import { numberField } from "./fields.js";

const MODES = {
  set: { text: "Set", title: "Set to a value", says: "Draws the sizes under the brush towards the target." },
  add: {
    text: "Add",
    title: "Add or subtract",
    says: "Makes the sizes under the brush larger. Alt, or a negative amount, makes them smaller.",
  },
  smooth: { text: "Smooth", title: "Smooth", says: "Draws every size towards the mean around it." },
  erase: {
    text: "Erase",
    title: "Erase painted sizes",
    says: "Drops painted sizes: the stars follow the profile again.",
  },
  remove: {
    text: "Remove",
    title: "Remove or restore stars",
    says: "Removes the stars under the brush. Hold Alt to bring them back.",
  },
};

/**
 * What the panels of both brushes have: `change(patch)` of its `setting` in the store, `says` about the mode, and
 * `field(label, key, options, factor)`, a number of the brush; `update` shows the brush as it is.
 */
export function brushParts({ store }, { setting, modes, prefix = "" }) {
  const brush = () => brushOn(store.get("sheet"), store.get(setting));
  const change = (patch) => store.set({ [setting]: { ...store.get(setting), ...patch } });
  const mode = segments({
    label: "Brush mode",
    testid: `${prefix}mode`,
    options: modes,
    value: brush().mode,
    onchange: (value) => change({ mode: value }),
  });
  const field = (label, key, options, factor = 1) =>
    numberField({
      label,
      value: factor * brush()[key],
      slider: true,
      testid: prefix + key,
      onchange: (value) => change({ [key]: value / factor }),
      ...options,
    });
  const radius = field("Radius", "radius", { step: 0.5, min: RADII[0], max: RADII[1] });
  const strength = field("Strength", "strength", { unit: "%", min: 1, max: 100, step: 1 }, 100);
  const says = hint("");
  function update() {
    const now = brush();
    says.textContent = modes[now.mode].says;
    mode.set(now.mode);
    radius.set(now.radius);
    strength.set(Math.round(100 * now.strength));
  }
  return { brush, change, mode, says, field, radius, strength, update };
}

export function brushPanel({ store }, { on }) {
  const parts = brushParts({ store }, { setting: "brush", modes: MODES });
  const { brush, change, mode, says, field, radius, strength } = parts;
  const quantity = segments({
    label: "Size to paint",
    testid: "quantity",
    options: QUANTITY_NAMES,
    value: brush().quantity,
    onchange: (value) => change(valuesFor(store.get("sheet"), value)),
  });
  const target = field("Target", "target", { step: 0.1, digits: 2 });
  const amount = field("Amount", "amount", { min: -5, max: 5, step: 0.05, digits: 2 });
  const inLaw = check({
    text: "Stay within the calibrated range",
    value: store.get("inLaw"),
    testid: "in-law",
    onchange: (value) => store.set({ inLaw: value }),
  });
  const range = hint("");
  const own = hint("");

  function update() {
    const isOfRods = Boolean(store.get("sheet")?.isOfRods);
    for (const name of ["quantity-length", "mode-erase", "mode-remove"]) {
      for (const one of [quantity, mode]) one.element.querySelector(`[data-testid='${name}']`)?.toggleAttribute("hidden", isOfRods);
    }
    const { quantity: name, mode: way, target: wanted, amount: more } = brush();
    const sheet = store.get("sheet");
    const [low, high] = sheet?.range(name, store.get("inLaw")) ?? [0, 20];
    parts.update();
    const printable = sheet?.printable(name);
    const most = isOfRods ? Math.min(high, QUANTITIES[name].usual) : high;
    target.limits(low, most);
    target.set(Math.min(Math.max(wanted, low), most));
    amount.limits(-10 * QUANTITIES[name].step, 10 * QUANTITIES[name].step);
    amount.set(more);
    quantity.set(name);
    target.element.hidden = way !== "set";
    amount.element.hidden = way !== "add";
    strength.element.hidden = way === "erase" || way === "remove";
    quantity.element.hidden = way === "erase" || way === "remove";
    range.hidden = quantity.element.hidden;
    inLaw.element.hidden = range.hidden || isOfRods; // cells of rods are solved for the sizes that are painted
    const text = `${plainly(low)} to ${plainly(high)} mm`;
    range.textContent = `${store.get("inLaw") && !isOfRods ? "Calibrated" : "Allowed"}: ${text}.${printable ? ` Printable: steps of ${plainly(printable.step)} mm.` : ""}`;
  }
  function tellOwn() {
    const { key, name } = QUANTITIES[brush().quantity];
    const sheet = store.get("sheet");
    own.hidden = !sheet?.isOfRods || !namesWithOwn(sheet.design, key).size;
    own.textContent = `Lines with a ${name.toLowerCase()} of their own keep it. The tool Sizes changes it.`;
  }
  on(["brush", "inLaw", "sheet"], update);
  on(["brush", "document"], tellOwn); // not at each dab
  update();
  tellOwn();
  return [
    mode.element,
    says,
    quantity.element,
    target.element,
    amount.element,
    radius.element,
    strength.element,
    inLaw.element,
    range,
    own,
    ...symmetry({ store }, { on }),
  ];
}

/** What the brush paints with at first: the middle of the sizes that the sheet has. */
function valuesFor(sheet, quantity) {
  const { step } = QUANTITIES[quantity];
  const [low, high] = sheet?.range(quantity, true) ?? [0, 10];
  const present = sheet?.values(quantity).sort((a, b) => a - b);
  const value = present?.length ? present[present.length >> 1] : (low + high) / 2;
  return { quantity, target: Math.round(value / step) * step, amount: 2 * step };
}

/** Rods are drawn: they have no lengths, and the brush does not erase or remove them. */
export function fitBrushToRods(store) {
  const brush = store.get("brush");
  if (brush.quantity === "length") {
    const { target, amount } = valuesFor(store.get("sheet"), "thickness");
    store.set({ brush: { ...brush, quantity: "thickness", mode: "set", target: target + amount, amount } });
  } else if (brush.mode === "erase" || brush.mode === "remove") store.set({ brush: { ...brush, mode: "set" } });
}

/** Mirrors and sixfold symmetry while painting. */
export function symmetry({ store }, { on }) {
  const boxes = Object.entries({ mirrorX: "Left–right", mirrorY: "Top–bottom", sixfold: "Sixfold" }).map(([key, text]) => {
    const box = check({
      text,
      value: store.get("symmetry")[key],
      testid: key,
      onchange: (value) => store.set({ symmetry: { ...store.get("symmetry"), [key]: value } }),
    });
    on(["symmetry"], ({ symmetry }) => box.set(symmetry[key]));
    return box;
  });
  return [section("Symmetry"), h("div", { class: "row wrap" }, boxes.map((one) => one.element))];
}

const plainly = (value) => String(Number(value.toFixed(3)));
