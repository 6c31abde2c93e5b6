// Panel of the shape: its state and numbers, warnings, other forms, verification, kept designs A, B, C.

import { MEANINGS } from "../badge.js";
import { button, h, hint, refresh, replace, section } from "../dom.js";
import { capital, fixed, mm, percent, seconds, size } from "../format.js";
import { icon } from "../icons.js";
import { formsPart } from "./forms.js";
import { fitPart } from "./fit.js";
import { targetPart } from "./target.js";

export function shapePanel(studio, page) {
  const { store, connection, actions } = studio;
  const { on } = page;
  const trusted = h("div", { class: "trust", testid: "trust" });
  const figures = h("dl", { class: "figures" });
  const warnings = h("div", {});
  const verified = h("div", { testid: "verification" });
  const slots = h("div", {});

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
      others.length
        ? h(
            "ul",
            { class: "list" },
            others.map((text) =>
              h("li", { class: "item warn" }, icon("warn"), h("span", { class: "grow" }, capital(text))),
            ),
          )
        : null,
    ];
  }

  function kept() {
    const { slots: all = {}, numbers = {} } = store.get("state");
    const rows = ["A", "B", "C"].map((slot) => [slot, all[slot]]);
    const present = {
      height_mm: numbers.height_mm ?? store.get("frame")?.height_mm,
      extent_mm: numbers.extent_mm,
      state: store.get("badge").words,
    };
    const isAny = rows.some(([, entry]) => entry);
    refresh(slots, [all, present, Boolean(store.get("document"))], () => [
      section("Compare designs"),
      isAny
        ? h(
            "table",
            { class: "small", testid: "slots" },
            h(
              "thead",
              {},
              h(
                "tr",
                {},
                ["mm", "Height", "Size", "State", ""].map((text) => h("th", { scope: "col" }, text)),
              ),
            ),
            h(
              "tbody",
              {},
              line("Now", present, null),
              rows.filter(([, entry]) => entry).map(([slot, entry]) => line(slot, entry, present)),
            ),
          )
        : hint("Keep a design as A, B or C, change it, and compare."),
      isAny ? hint("Small numbers: difference from the design that is shown now.") : null,
      h(
        "div",
        { class: "row tight" },
        rows.map(([slot, entry]) =>
          h(
            "span",
            { class: "grow" },
            button({
              text: entry ? `Replace ${slot}` : `Keep as ${slot}`,
              kind: "wide",
              testid: `keep-${slot}`,
              disabled: !store.get("document"),
              onclick: () => connection.send("keep", { slot }),
            }),
          ),
        ),
      ),
    ]);
  }

  function line(slot, entry, present) {
    const change = (value, base, digits) => {
      if (!present || !Number.isFinite(value) || !Number.isFinite(base)) return null;
      const off = value - base;
      return Math.abs(off) < 10 ** -digits / 2
        ? null
        : h("div", { class: "unit-tag" }, `${off > 0 ? "+" : ""}${fixed(off, digits)}`);
    };
    const sizeChange = (values, bases) => {
      const off = values && bases ? [0, 1].map((k) => Math.round(values[k]) - Math.round(bases[k])) : [0, 0];
      if (!present || !off.some(Boolean)) return null;
      return h("div", { class: "unit-tag" }, off.map((one) => `${one > 0 ? "+" : ""}${fixed(one, 0)}`).join(" × "));
    };
    return h(
      "tr",
      {},
      h("td", {}, h("b", {}, slot)),
      h("td", {}, fixed(entry.height_mm), change(entry.height_mm, present?.height_mm, 1)),
      h(
        "td",
        {},
        entry.extent_mm
          ? entry.extent_mm
              .slice(0, 2)
              .map((value) => fixed(value, 0))
              .join(" × ")
          : "–",
        sizeChange(entry.extent_mm, present?.extent_mm),
      ),
      h("td", {}, entry.state),
      h(
        "td",
        {},
        present
          ? button({
              text: "Show",
              label: `Show design ${slot}`,
              kind: "plain show",
              testid: `show-${slot}`,
              onclick: () => connection.send("show", { slot }),
            })
          : null,
      ),
    );
  }

  on(["state", "badge", "frame", "document"], () => (update(), kept()));
  on(["jobs", "results", "document", "state"], verification);
  update();
  verification();
  kept();
  return [
    section("Shape"),
    trusted,
    figures,
    warnings,
    formsPart(studio, page),
    verified,
    slots,
    targetPart(studio, page),
    fitPart(studio, page),
  ];
}
