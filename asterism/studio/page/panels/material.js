// Panel of fabric, plastic, stars and printer. What the law does not allow is shown as such before it is tried.

import { borderOf } from "../border.js";
import { bound, check, choice, figures, follow, h, hint, labelled, part, section, wide } from "../dom.js";
import { fixed } from "../format.js";
import { roundPoint } from "../geometry.js";
import { patternOf, stretchOf } from "../sheet.js";
import { withRatio } from "../supports.js";
import { numberField } from "./fields.js";

// of a design that says nothing
const DEFAULTS = { spacing_mm: 10 * Math.sqrt(3), arms: 3, orientation_deg: 0, kind: "triangular" };
const BRANCHES = { up: "To the plastic's side", down: "To the fabric's side", free: "As they find it" };
const SIDES = { above: "Above the fabric", below: "Below the fabric" };
const DEFAULT_ROUNDING = { first_layer_mm: 0.3, layer_mm: 0.2, line_mm: 0.4 };

export function materialPanel({ store, edits, connection, actions }, { on }) {
  const send = (changes) => edits.once(() => edits.design(changes));
  const sheet = () => store.get("sheet");
  const design = () => sheet()?.design ?? {};
  const printers = () => store.get("document")?.printers ?? [];
  /** A number of the design file, by its section and key. */
  const number = (label, table, key, otherwise, options) =>
    numberField({
      label,
      field: `${table}.${key}`,
      value: () => design()[table]?.[key] ?? otherwise,
      onchange: (value) => send({ [`${table}.${key}`]: value }),
      ...options,
    });

  let follows = null; // {number, tables, from}: the stretch for which needles stand that have not followed
  const isEven = () => !Array.isArray(design().fabric?.stretch);
  const isBehind = () =>
    follows?.number === store.get("document").number && follows.tables === JSON.stringify(sheet().tables);
  const stretched = (value) => {
    const from = isBehind() ? follows.from : stretchOf(design())[0];
    follows = { number: store.get("document").number, tables: JSON.stringify(sheet().tables), from };
    send({ "fabric.stretch": value });
  };
  const ratio = () =>
    sheet()?.tables.length && isBehind() && isEven() ? follows.from / stretchOf(design())[0] : 1;
  const stretchText = () => (isEven() ? lawText(sheet()?.limits) : `${stretchOf(design()).join(" × ")}, unequal.`);

  const rounding = () => design()[patternOf(design())]?.rounding;
  const roundingText = () => {
    const steps = rounding();
    if (!steps) return "Thickness becomes whole layers and width whole lines, as the printer makes them.";
    return `First layer ${steps.first_layer_mm} mm, then ${steps.layer_mm} mm; lines of ${steps.line_mm} mm.`;
  };

  const kind = () => design().lattice?.kind ?? DEFAULTS.kind;
  /** A key of the lattice changed; on a lattice without rings the outline stays as it is. */
  const arrange = (key, value) => {
    const { design: now, outline } = sheet();
    const isLost = key === "kind" && now.border?.rings !== undefined;
    const border = isLost ? { border: borderOf(now, { polygon_mm: outline.map((corner) => roundPoint(corner)) }) } : {};
    send({ [`lattice.${key}`]: value, ...border });
    if (key === "spacing_mm" && now.border?.rings !== undefined) actions.fitSoon(); // another outline
  };
  const lattice = (label, key, options) => {
    const rest = { testid: `lattice-${key}`, onchange: (value) => arrange(key, value), ...options };
    return number(label, "lattice", key, DEFAULTS[key], rest);
  };
  const kinds = () => ({
    triangular: "Triangular lattice",
    square: "Square lattice",
    custom: { text: "Own lattice", disabled: kind() !== "custom" },
  });
  const isOwn = () => kind() === "custom";
  /** A choice of the stars; a design that says nothing has the first one. */
  const ofStars = (label, key, options) =>
    choice({
      label,
      testid: key,
      options,
      value: () => design().stars?.[key] ?? Object.keys(options)[0],
      onchange: (value) => send({ [`stars.${key}`]: value }),
    });
  const printerText = ({ name, title, area_mm: [x, y] }) => `${title ?? name}, ${x} × ${y} mm`;

  const facts = () => [
    ...(sheet()?.isOfRods ? [["Rods", String(sheet().rods.length)]] : []),
    ["Plastic over fabric modulus", String(design().plastic?.modulus_ratio ?? 3200)],
    ["Printed size", `${(sheet()?.box.size ?? [0, 0]).map((side) => fixed(side, 0)).join(" × ")} mm`],
  ];
  return follow(on, ["sheet", "document", "printArea"], [
    section("Fabric"),
    number("Stretch, printed over released", "fabric", "stretch", 1.35, {
      unit: "",
      min: 1,
      max: 3,
      step: 0.05,
      digits: 3,
      testid: "stretch",
      value: () => (isEven() ? stretchOf(design())[0] : null),
      disabled: () => !isEven(),
      onchange: stretched,
    }),
    hint(stretchText),
    part("needles-follow", ratio, (by) =>
      by === 1
        ? []
        : [
            hint(`The needles stand as for a stretch of ${fixed(follows.from, 2)}, so that the sheet gets another height.`),
            wide(`Move the needles along: their distances × ${fixed(by, 2)}`, "follow-stretch", () => {
              const pins = withRatio(sheet().tables, by);
              follows = null;
              edits.once(() => edits.design({ pins }, { pins }));
            }),
          ],
    ),
    number("Released thickness", "fabric", "thickness_mm", 0.8, {
      min: 0.01,
      max: 10,
      step: 0.05,
      testid: "fabric-thickness",
    }),
    section("Plastic"),
    number("Peeled curvature", "plastic", "kappa_bar_per_mm", 0, {
      unit: "1/mm",
      min: -1,
      max: 1,
      step: 0.001,
      digits: 4,
      testid: "kappa",
      value: () => (typeof kappaOf(design()) === "number" ? kappaOf(design()) : 0),
      hidden: () => typeof kappaOf(design()) !== "number",
    }),
    check({
      text: "Round to printable layers and lines",
      testid: "rounding",
      value: () => Boolean(rounding()),
      onchange: (isOn) =>
        send({ [`${patternOf(design())}.rounding`]: isOn ? (sheet().limits.rounding ?? DEFAULT_ROUNDING) : null }),
    }),
    hint(roundingText),
    h("div", { hidden: () => Boolean(sheet()?.isOfRods) }, [
      section("Stars"),
      h("div.row", [
        choice({
          label: "Lattice of the stars",
          testid: "lattice",
          options: kinds,
          value: kind,
          onchange: (value) => arrange("kind", value),
          disabled: isOwn,
        }),
      ]),
      lattice("Spacing", "spacing_mm", {
        min: 1,
        max: 500,
        step: 0.5,
        digits: 2,
        value: () => sheet()?.spacing ?? DEFAULTS.spacing_mm,
        disabled: isOwn,
      }),
      lattice("Arms of a star", "arms", { unit: "", min: 3, max: 8, whole: true }),
      lattice("Turned by", "orientation_deg", { unit: "°", min: -360, max: 360 }),
      hint("The preview learns another lattice when it is first used, in a minute or so."),
      labelled("Rise", ofStars("Stars rise", "branch", BRANCHES)),
      labelled("Plastic", ofStars("Plastic of the stars", "side", SIDES)),
    ]),
    section("Printer"),
    h("div.row", [
      choice({
        label: "Printer",
        testid: "printer",
        options: () => printers().map((one) => ({ value: one.name, text: printerText(one) })),
        value: () => sheet()?.printer?.name ?? "",
        onchange: (name) => connection.send("printer", { name }),
      }),
    ]),
    check({ text: "Show its frame and printable area", testid: "print-area", ...bound(store, "printArea") }),
    section("Sheet"),
    part(null, facts, (rows) => figures(rows)),
  ]);
}

const kappaOf = ({ plastic }) => plastic?.kappa_bar_per_mm ?? 0;

function lawText({ stretches = [] } = {}) {
  if (!stretches.length) return "";
  const known = stretches.map((value) => fixed(value, 2)).join(" and ");
  return `The preview knows ${known}. It learns other stretches when they are first used, in some seconds.`;
}
