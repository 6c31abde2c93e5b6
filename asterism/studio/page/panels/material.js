// Panel of fabric, plastic, stars and printer. What the law does not allow is shown as such before it is tried.

import { borderOf } from "../border.js";
import { button, check, choice, figureRows, h, hint, labelled, refresh, replace, section } from "../dom.js";
import { fixed } from "../format.js";
import { roundPoint } from "../geometry.js";
import { patternOf } from "../sheet.js";
import { withRatio } from "../supports.js";
import { numberField } from "./fields.js";

const LATTICE = { spacing_mm: 10 * Math.sqrt(3), arms: 3, orientation_deg: 0 }; // of a design that says nothing
const DEFAULT_ROUNDING = { first_layer_mm: 0.3, layer_mm: 0.2, line_mm: 0.4 };

export function materialPanel({ store, edits, connection, actions }, { on }) {
  const send = (changes) => edits.once(() => edits.design(changes));
  const design = () => store.get("sheet")?.design ?? {};
  const stretch = numberField({
    label: "Stretch, printed over released",
    unit: "",
    value: 1.35,
    min: 1,
    max: 3,
    step: 0.05,
    digits: 3,
    testid: "stretch",
    field: "fabric.stretch",
    onchange: (value) => {
      const { number } = store.get("document");
      const { tables } = store.get("sheet");
      // the stretch for which the needles stand, as long as they have not followed
      const isKnown = follows?.number === number && follows.tables === JSON.stringify(tables);
      follows = { number, tables: JSON.stringify(tables), from: isKnown ? follows.from : (design().fabric?.stretch ?? 1.35) };
      send({ "fabric.stretch": value });
    },
  });
  let follows = null;
  const stretchHint = hint("");
  const needles = h("div", { testid: "needles-follow" });
  const valueField = (field, rest) => numberField({ field, onchange: (value) => send({ [field]: value }), ...rest });
  const thickness = valueField("fabric.thickness_mm", {
    label: "Released thickness",
    value: 0.8,
    min: 0.01,
    max: 10,
    step: 0.05,
    testid: "fabric-thickness",
  });
  const kappa = valueField("plastic.kappa_bar_per_mm", {
    label: "Peeled curvature",
    unit: "1/mm",
    value: 0,
    min: -1,
    max: 1,
    step: 0.001,
    digits: 4,
    testid: "kappa",
  });
  const printer = choice({
    label: "Printer",
    testid: "printer",
    options: [],
    value: "",
    onchange: (name) => connection.send("printer", { name }),
  });
  const area = check({
    text: "Show its frame and printable area",
    value: store.get("printArea"),
    testid: "print-area",
    onchange: (value) => store.set({ printArea: value }),
  });
  const rounding = check({
    text: "Round to printable layers and lines",
    value: false,
    testid: "rounding",
    onchange: (value) =>
      send({ [`${patternOf(design())}.rounding`]: value ? (store.get("sheet").limits.rounding ?? DEFAULT_ROUNDING) : null }),
  });
  const roundingHint = hint("");
  /** A key of the lattice changed; on a lattice without rings the outline stays as it is. */
  const arrange = (key, value) => {
    const { design: now, outline } = store.get("sheet");
    const isLost = key === "kind" && now.border?.rings !== undefined;
    const border = isLost ? { border: borderOf(now, { polygon_mm: outline.map((corner) => roundPoint(corner)) }) } : {};
    send({ [`lattice.${key}`]: value, ...border });
    if (key === "spacing_mm" && now.border?.rings !== undefined) actions.fitSoon(); // another outline
  };
  const lattice = choice({
    label: "Lattice of the stars",
    testid: "lattice",
    options: { triangular: "Triangular lattice", square: "Square lattice", custom: "Own lattice" },
    value: "triangular",
    onchange: (value) => arrange("kind", value),
  });
  const latticeField = (label, key, rest) =>
    numberField({
      label,
      value: LATTICE[key],
      testid: `lattice-${key}`,
      field: `lattice.${key}`,
      onchange: (value) => arrange(key, value),
      ...rest,
    });
  const places = {
    spacing_mm: latticeField("Spacing", "spacing_mm", { min: 1, max: 500, step: 0.5, digits: 2 }),
    arms: latticeField("Arms of a star", "arms", { unit: "", min: 3, max: 8, whole: true }),
    orientation_deg: latticeField("Turned by", "orientation_deg", { unit: "°", min: -360, max: 360 }),
  };
  const branch = choice({
    label: "Stars rise",
    testid: "branch",
    options: { up: "To the plastic's side", down: "To the fabric's side", free: "As they find it" },
    value: "up",
    onchange: (value) => send({ "stars.branch": value }),
  });
  const side = choice({
    label: "Plastic of the stars",
    testid: "side",
    options: { above: "Above the fabric", below: "Below the fabric" },
    value: "above",
    onchange: (value) => send({ "stars.side": value }),
  });
  const stars = h(
    "div",
    {},
    section("Stars"),
    h("div", { class: "row" }, lattice.element),
    Object.values(places).map((one) => one.element),
    hint("The preview learns another lattice when it is first used, in a minute or so."),
    labelled("Rise", branch),
    labelled("Plastic", side),
  );
  const facts = h("dl", { class: "figures" });

  function update() {
    const now = design();
    const sheet = store.get("sheet");
    if (!sheet) return;
    const present = now.fabric?.stretch ?? 1.35;
    const isEven = !Array.isArray(present);
    stretch.input.disabled = !isEven;
    if (isEven) stretch.set(present);
    const isBehind = follows?.number === store.get("document").number && follows.tables === JSON.stringify(sheet.tables);
    const ratio = isBehind && isEven && sheet.tables.length ? follows.from / present : 1;
    refresh(needles, [ratio], () =>
      ratio === 1
        ? []
        : [
            hint(`The needles stand as for a stretch of ${fixed(follows.from, 2)}, so that the sheet gets another height.`),
            button({
              text: `Move the needles along: their distances × ${fixed(ratio, 2)}`,
              kind: "wide",
              testid: "follow-stretch",
              onclick: () => {
                const tables = withRatio(store.get("sheet").tables, ratio);
                follows = null;
                edits.once(() => edits.design({ pins: tables }, { pins: tables }));
              },
            }),
          ],
    );
    stretchHint.textContent = isEven ? lawText(sheet.limits) : `${present.join(" × ")}, unequal.`;
    thickness.set(now.fabric?.thickness_mm ?? 0.8);
    const bar = now.plastic?.kappa_bar_per_mm ?? 0;
    kappa.element.hidden = typeof bar !== "number";
    if (typeof bar === "number") kappa.set(bar);
    branch.set(now.stars?.branch ?? "up");
    side.set(now.stars?.side ?? "above");
    const steps = now[patternOf(now)]?.rounding;
    rounding.set(Boolean(steps));
    roundingHint.textContent = steps
      ? `First layer ${steps.first_layer_mm} mm, then ${steps.layer_mm} mm; lines of ${steps.line_mm} mm.`
      : "Thickness becomes whole layers and width whole lines, as the printer makes them.";
    const { printers = [] } = store.get("document");
    printer.element.replaceChildren(
      ...printers.map(({ name, title, area_mm: size }) =>
        h("option", { value: name }, `${title ?? name}, ${size[0]} × ${size[1]} mm`),
      ),
    );
    printer.set(sheet.printer?.name ?? "");
    stars.hidden = sheet.isOfRods;
    const { kind = "triangular", ...own } = now.lattice ?? {};
    lattice.set(kind);
    lattice.element.querySelector('[value="custom"]').disabled = kind !== "custom";
    lattice.element.disabled = places.spacing_mm.input.disabled = kind === "custom";
    for (const [key, one] of Object.entries(places)) one.set(key === "spacing_mm" ? sheet.spacing : (own[key] ?? LATTICE[key]));
    const rows = [
      ...(sheet.isOfRods ? [["Rods", String(sheet.rods.length)]] : []),
      ["Plastic over fabric modulus", String(now.plastic?.modulus_ratio ?? 3200)],
      ["Printed size", `${fixed(sheet.box.size[0], 0)} × ${fixed(sheet.box.size[1], 0)} mm`],
    ];
    replace(facts, figureRows(rows));
  }
  on(["sheet", "document"], update);
  on(["printArea"], ({ printArea }) => area.set(printArea));
  update();
  return [
    section("Fabric"),
    stretch.element,
    stretchHint,
    needles,
    thickness.element,
    section("Plastic"),
    kappa.element,
    rounding.element,
    roundingHint,
    stars,
    section("Printer"),
    h("div", { class: "row" }, printer.element),
    area.element,
    section("Sheet"),
    facts,
  ];
}

function lawText({ stretches }) {
  if (!stretches.length) return "";
  const known = stretches.map((value) => fixed(value, 2)).join(" and ");
  return `The preview knows ${known}. It learns other stretches when they are first used, in some seconds.`;
}
