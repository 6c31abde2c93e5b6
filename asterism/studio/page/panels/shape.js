// Panel of the shape: its state and numbers, warnings, other forms and designs, verification, target, fit.

import { MEANINGS } from "../badge.js";
import { counted, figures, follow, h, hint, listItem, part, section } from "../dom.js";
import { capital, mm, percent, size } from "../format.js";
import { fitPart, spreadPart, verifyPart } from "./jobs.js";
import { stripPart } from "./strip.js";
import { targetPart } from "./target.js";

const SIDES = { down: "outside (convex)", up: "inside (concave)" };

export function shapePanel(studio, page) {
  const { store, actions } = studio;
  const badge = () => store.get("badge");

  function rows() {
    const { numbers = {} } = store.get("state");
    const frame = store.get("frame");
    const number = (value, text) => (Number.isFinite(value) ? text(value) : null);
    const about = number(numbers.expected_height_percent, (share) => ` ± ${percent(share, 0)}`) ?? "";
    return [
      ["Height", frame ? `${mm(numbers.height_mm ?? frame.height_mm)}${about}` : "–"],
      ["Over the needles", number(numbers.above_needles_mm, mm)],
      ["Below the needles", number(numbers.below_needles_mm, mm)],
      ["Size", numbers.extent_mm ? size(numbers.extent_mm) : "–"],
      ["Shrinks to", number(numbers.contraction, (value) => `${percent(100 * value)} of the print`)],
      ["Radius of the roll", number(numbers.roll_radius_mm, mm)],
      ["Plastic is", SIDES[numbers.side] ?? null],
    ].filter(([, value]) => value !== null);
  }
  const warning = (one) =>
    listItem({ icon: "warn", kind: "warn", text: capital(one.text), onclick: () => actions.showPlace(one) });
  const warnings = (all) =>
    all.length ? h("ul.list", { testid: "warning-list" }, all.map(warning)) : hint("None.");

  return follow(page.on, ["state", "badge", "frame", "document", "jobs", "results", "showTarget"], [
    section("Shape"),
    h("div.trust", { testid: "trust" }, h("div.big", () => badge().words), h("p", () => MEANINGS[badge().kind])),
    h("div", { className: () => (badge().isStale ? "stale" : "") }, part(null, rows, (all) => figures(all))),
    stripPart(studio, page),
    part(null, () => store.get("state").warnings ?? [], (all) => [counted("Warnings", all.length), warnings(all)]),
    verifyPart(studio),
    spreadPart(studio),
    targetPart(studio),
    fitPart(studio),
  ]);
}
