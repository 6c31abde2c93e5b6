// Panel of the shape: its state and numbers, warnings, other forms and designs, verification, target, fit.

import { MEANINGS } from "../badge.js";
import { counted, figureRows, h, hint, listItem, refresh, replace, section } from "../dom.js";
import { capital, fixed, mm, percent, size } from "../format.js";
import { fitPart, spreadPart, verifyPart } from "./jobs.js";
import { stripPart } from "./strip.js";
import { targetPart } from "./target.js";

export function shapePanel(studio, page) {
  const { store, actions } = studio;
  const { on } = page;
  const trusted = h("div", { class: "trust", testid: "trust" });
  const figures = h("dl", { class: "figures" });
  const warnings = h("div", {});

  function update() {
    const { numbers = {}, warnings: all = [] } = store.get("state");
    const frame = store.get("frame");
    const badge = store.get("badge");
    replace(trusted, h("div", { class: "big" }, badge.words), h("p", {}, MEANINGS[badge.kind]));
    figures.classList.toggle("stale", Boolean(badge.isStale));
    const number = (value, show) => (Number.isFinite(value) ? show(value) : null);
    const about = number(numbers.expected_height_percent, (share) => ` ± ${percent(share, 0)}`) ?? "";
    const rows = [
      ["Height", frame ? `${mm(numbers.height_mm ?? frame.height_mm)}${about}` : "–"],
      ["Over the needles", number(numbers.above_needles_mm, mm)],
      ["Below the needles", number(numbers.below_needles_mm, mm)],
      ["Size", numbers.extent_mm ? size(numbers.extent_mm) : "–"],
      ["Contraction", number(numbers.contraction, (value) => fixed(value, 3))],
      ["Radius of the roll", number(numbers.roll_radius_mm, mm)],
      ["Plastic is", { down: "outside (convex)", up: "inside (concave)" }[numbers.side] ?? null],
    ];
    replace(figures, figureRows(rows.filter(([, value]) => value !== null)));
    const item = (warning) =>
      listItem({
        icon: "warn",
        kind: "warn",
        text: capital(warning.text),
        onclick: () => actions.showPlace(warning),
      });
    refresh(warnings, [all], () => [
      counted("Warnings", all.length),
      all.length ? h("ul", { class: "list", testid: "warning-list" }, all.map(item)) : hint("None."),
    ]);
  }

  on(["state", "badge", "frame", "document"], update);
  update();
  return [
    section("Shape"),
    trusted,
    figures,
    stripPart(studio, page),
    warnings,
    verifyPart(studio, page),
    spreadPart(studio, page),
    targetPart(studio, page),
    fitPart(studio, page),
  ];
}
