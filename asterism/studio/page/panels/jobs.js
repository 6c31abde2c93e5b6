// Parts of the shape's panel about jobs beside the work: verification, range of prints, fit to the target.

import { button, choice, figures, fileLink, h, hint, labelled, refresh, section, warningList } from "../dom.js";
import { capital, mm, percent, plural, seconds } from "../format.js";

const HOLDS = { auto: "By the target", border: "Whole border", nothing: "Nothing" };

/**
 * A part about a job, built anew when what it shows has changed: `about()` is what else that depends on, null if there
 * is nothing to show. `found`: what the last job found, and the button for the next one.
 */
function jobPart({ store }, { on }, { job, title, testid, keys, about, found }) {
  const part = h("div", { testid });
  function update() {
    const { [job]: result } = store.get("results");
    const running = Object.keys(store.get("jobs")); // one job runs at a time
    const isOld = Boolean(result?.summary) && result.revision !== store.get("document")?.revision;
    const known = about(running);
    refresh(part, [result, isOld, running, known], () => {
      if (known === null) return [];
      const isRunning = running.includes(job);
      return [section(title), ...(isRunning ? [hint("Under way: see the line at the bottom.")] : found(result, known, isOld))];
    });
  }
  on(["jobs", "results", "document", ...keys], update);
  update();
  return part;
}

const old = (isOld) => (isOld ? hint("The design has changed since.") : null);

/** How far the preview is from exact shapes. */
export function verifyPart(studio, page) {
  const { store, actions } = studio;
  const known = () => new Set(store.get("state").warnings?.map(({ text }) => text));
  return jobPart(studio, page, {
    job: "verify",
    title: "Preview beside the exact model",
    testid: "verification",
    keys: ["state"],
    about: () => ({ isReady: Boolean(store.get("document") && store.get("state").has_preview) }),
    found(result, { isReady }, isOld) {
      const s = result?.summary;
      if (!s)
        return [
          hint(
            result?.cancelled
              ? "Cancelled. The preview is unchanged."
              : "Writes a report that compares the preview with exact shapes from two starts. It runs beside your work.",
          ),
          button({
            icon: "verify",
            text: "Verify",
            kind: "wide",
            testid: "verify-panel",
            disabled: !isReady,
            onclick: actions.verify,
          }),
        ];
      const [exact, preview] = s.heights_mm ?? [];
      const rows = [
        ["Distance, root mean square", `${mm((s.rms_percent / 100) * s.diameter_mm, 2)} (${percent(s.rms_percent)})`],
        ["Largest distance", mm((s.max_percent / 100) * s.diameter_mm, 2)],
        ["Exact height", mm(exact)],
        ["Preview's height", mm(preview)],
        ["Exact model took", seconds(s.exact_s)],
      ];
      const said = known();
      return [
        old(isOld),
        figures(rows.filter(([, value]) => !value.startsWith("–")), "verified"),
        h(
          "div",
          { class: "row wrap" },
          result.report ? fileLink(result.report, "report", "Report") : null,
          button({ icon: "verify", text: "Verify again", onclick: actions.verify }),
        ),
        warningList((s.warnings ?? []).filter((text) => !said.has(text)).map(capital)),
      ];
    },
  });
}

/** How much prints of the design differ from its exact shape. */
export const spreadPart = (studio, page) =>
  jobPart(studio, page, {
    job: "spread",
    title: "How much prints differ",
    testid: "spread",
    keys: ["badge"],
    about: () => ({ isExact: studio.store.get("badge").kind === "exact" }),
    found(result, { isExact }, isOld) {
      const has = Boolean(result?.summary);
      const start = button({
        text: has ? "Compute again" : "Range of prints",
        kind: has ? "" : "wide",
        testid: "spread-go",
        disabled: !isExact,
        onclick: studio.actions.spread,
      });
      if (!has) return [hint("Ten exact shapes tell what nobody knows exactly, such as the stretch, is worth."), start];
      const [file] = result.files;
      return [
        old(isOld),
        h(
          "div",
          { testid: "spread-found" },
          Object.entries(result.summary.rows).map(([name, text]) => h("p", {}, h("b", {}, `${capital(name)}: `), text)),
        ),
        h("div", { class: "row wrap" }, file && fileLink(file.name, "camera", "Picture"), start),
        warningList(result.warnings.map(capital)),
      ];
    },
  });

/** A fit of outline, stars and supports to the target. */
export function fitPart(studio, page) {
  const { store, actions } = studio;
  let hold = "auto";
  return jobPart(studio, page, {
    job: "fit",
    title: "Fit to the target",
    testid: "fit",
    keys: ["state"],
    about(running) {
      const { target } = store.get("state");
      return target && !running.includes("fit") ? { name: target.name } : null;
    },
    found: (result, known, isOld) => [
      ...(result?.summary
        ? fitted(result.summary, isOld)
        : [
            hint(
              result?.cancelled
                ? "Cancelled. The design is unchanged."
                : "Finds outline, stars and supports whose sheet comes near to the target. It replaces those of the design in one step, which Undo takes back, and runs beside your work.",
            ),
          ]),
      labelled(
        "Held",
        choice({
          label: "What holds the sheet",
          testid: "fit-hold",
          options: HOLDS,
          value: hold,
          onchange: (value) => (hold = value),
        }),
      ),
      button({
        text: "Paint where it comes nearer",
        kind: "wide",
        testid: "fit-weights",
        onclick: () => actions.choose("weight"),
      }),
      button({
        text: result?.summary ? "Fit again" : "Fit to the target",
        kind: "wide",
        testid: "fit-go",
        disabled: Object.keys(store.get("jobs")).length > 0,
        onclick: () => actions.fitToTarget(hold),
      }),
    ],
  });
}

/** What a fit came to. */
function fitted(s, isOld) {
  const rows = [
    ["Distance by the preview, rms", `${percent(s.preview.mean_percent, 2)} of the diameter`],
    ...(s.preview.weighted_percent === s.preview.mean_percent
      ? []
      : [["The same by the weights", percent(s.preview.weighted_percent, 2)]]),
    ["Largest distance", percent(s.preview.largest_percent, 1)],
    ["Stars", String(s.stars)],
    ["Held by", s.held_border ? "the border" : s.needles ? plural(s.needles, "needle") : "nothing"],
    ["Contraction needed", s.needed_ratio.toFixed(2)],
    ["Contraction available", s.available_ratio.toFixed(2)],
    ["Loss by rounding", s.rounding_loss_percent === null ? "–" : percent(s.rounding_loss_percent, 2)],
  ];
  return [figures(rows, "fit-numbers"), ...s.warnings.map((line) => hint(capital(line))), old(isOld)];
}
