// Panel of the shape: its state and numbers, warnings, other forms and designs, verification, target, fit.

import { MEANINGS } from "../badge.js";
import { button, h, hint, refresh, replace, section, warningList } from "../dom.js";
import { capital, fixed, mm, percent, seconds, size } from "../format.js";
import { icon } from "../icons.js";
import { fitPart } from "./fit.js";
import { stripPart } from "./strip.js";
import { spreadPart } from "./spread.js";
import { targetPart } from "./target.js";

export function shapePanel(studio, page) {
  const { store, actions } = studio;
  const { on } = page;
  const trusted = h("div", { class: "trust", testid: "trust" });
  const figures = h("dl", { class: "figures" });
  const warnings = h("div", {});
  const verified = h("div", { testid: "verification" });

  function update() {
    const { numbers = {}, warnings: all = [] } = store.get("state");
    const frame = store.get("frame");
    const badge = store.get("badge");
    replace(trusted, h("div", { class: "big" }, badge.words), h("p", {}, MEANINGS[badge.kind]));
    figures.classList.toggle("stale", Boolean(badge.isStale));
    const rows = [
      [
        "Height",
        frame
          ? `${mm(numbers.height_mm ?? frame.height_mm)}${Number.isFinite(numbers.expected_height_percent) ? ` ± ${percent(numbers.expected_height_percent, 0)}` : ""}`
          : "–",
      ],
      ["Over the needles", Number.isFinite(numbers.above_needles_mm) ? mm(numbers.above_needles_mm) : null],
      ["Below the needles", Number.isFinite(numbers.below_needles_mm) ? mm(numbers.below_needles_mm) : null],
      ["Size", numbers.extent_mm ? size(numbers.extent_mm) : "–"],
      ["Contraction", Number.isFinite(numbers.contraction) ? fixed(numbers.contraction, 3) : null],
      ["Radius of the roll", Number.isFinite(numbers.roll_radius_mm) ? mm(numbers.roll_radius_mm) : null],
      ["Plastic is", numbers.side === "down" ? "outside (convex)" : numbers.side === "up" ? "inside (concave)" : null],
    ].filter(([, value]) => value !== null);
    replace(
      figures,
      rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]),
    );
    refresh(warnings, [all], () => [
      section("Warnings", h("span", { class: "count" }, String(all.length))),
      all.length
        ? h(
            "ul",
            { class: "list", testid: "warning-list" },
            all.map((warning) =>
              h(
                "li",
                {},
                h(
                  "button",
                  { type: "button", class: "item warn", onclick: () => actions.showPlace(warning) },
                  icon("warn"),
                  h("span", { class: "grow" }, capital(warning.text)),
                ),
              ),
            ),
          )
        : hint("None."),
    ]);
  }

  function verification() {
    const { verify: result } = store.get("results");
    const isRunning = Boolean(store.get("jobs").verify);
    const document = store.get("document");
    const isOld = result?.revision !== document?.revision;
    refresh(verified, [result, isOld, isRunning, Boolean(document), store.get("state").has_preview], () => [
      section("Preview beside the exact model"),
      ...(isRunning ? [hint("Under way: see the line at the bottom.")] : verdict(result, isOld)),
    ]);
  }

  /** What a verification found, or the button that starts one. */
  function verdict(result, isOld) {
    if (!result?.summary) {
      const about = result?.cancelled
        ? "Cancelled. The preview is unchanged."
        : "Writes a report that compares the preview with exact shapes from two starts. It runs beside your work.";
      return [
        hint(about),
        button({
          icon: "verify",
          text: "Verify",
          kind: "wide",
          testid: "verify-panel",
          disabled: !store.get("document") || !store.get("state").has_preview,
          onclick: actions.verify,
        }),
      ];
    }
    const s = result.summary;
    const [exact, preview] = s.heights_mm ?? [];
    const rows = [
      ["Distance, root mean square", `${mm((s.rms_percent / 100) * s.diameter_mm, 2)} (${percent(s.rms_percent)})`],
      ["Largest distance", mm((s.max_percent / 100) * s.diameter_mm, 2)],
      ["Exact height", mm(exact)],
      ["Preview's height", mm(preview)],
      ["Exact model took", seconds(s.exact_s)],
    ].filter(([, value]) => !value.startsWith("–"));
    const known = new Set((store.get("state").warnings ?? []).map(({ text }) => text));
    const others = (s.warnings ?? []).filter((text) => !known.has(text));
    return [
      isOld ? hint("The design has changed since.") : null,
      h(
        "dl",
        { class: "figures", testid: "verified" },
        rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]),
      ),
      h(
        "div",
        { class: "row wrap" },
        result.report
          ? h(
              "a",
              { class: "button", href: `file/${encodeURI(result.report)}`, target: "_blank", rel: "noopener" },
              icon("report"),
              "Report",
            )
          : null,
        button({ icon: "verify", text: "Verify again", onclick: actions.verify }),
      ),
      warningList(others.map(capital)),
    ];
  }

  on(["state", "badge", "frame", "document"], update);
  on(["jobs", "results", "document", "state"], verification);
  update();
  verification();
  return [
    section("Shape"),
    trusted,
    figures,
    stripPart(studio, page),
    warnings,
    verified,
    spreadPart(studio, page),
    targetPart(studio, page),
    fitPart(studio, page),
  ];
}
