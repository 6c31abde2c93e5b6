// Parts of the shape's panel about jobs beside the work: verification, range of prints, fit to the target.

import { button, choice, figures, fileLink, h, hint, labelled, part, section, warningList, wide } from "../dom.js";
import { capital, mm, percent, plural, seconds } from "../format.js";

const HOLDS = { auto: "By the target", border: "Whole border", nothing: "Nothing" };

/**
 * A part about a job: `about()` is what it depends on besides results, null if there is nothing to show. `found`: what
 * the last job found, and the button for the next one.
 */
function jobPart({ store }, { job, title, testid, about, found }) {
  function known() {
    const { [job]: result = null } = store.get("results");
    const running = Object.keys(store.get("jobs")); // one job runs at a time
    const isOld = Boolean(result?.summary) && result.revision !== store.get("document")?.revision;
    return { result, isOld, running, about: about() };
  }
  return part(testid, known, ({ result, isOld, running, about: what }) => {
    if (what === null) return [];
    if (running.includes(job)) return [section(title), hint("Under way: see the line at the bottom.")];
    return [section(title), found(result, what, isOld ? hint("The design has changed since.") : null)];
  });
}

/** How far the preview is from exact shapes. */
export function verifyPart(studio) {
  const { store, actions } = studio;
  return jobPart(studio, {
    job: "verify",
    title: "Preview beside the exact model",
    testid: "verification",
    about: () => ({ isReady: Boolean(store.get("document") && store.get("state").has_preview) }),
    found(result, { isReady }, old) {
      const s = result?.summary;
      const go = (text, rest) => button({ icon: "verify", text, onclick: actions.verify, ...rest });
      const about = result?.cancelled
        ? "Cancelled. The preview is unchanged."
        : "Writes a report that compares the preview with exact shapes from two starts. It runs beside your work.";
      if (!s) return [hint(about), go("Verify", { kind: "wide", testid: "verify-panel", disabled: !isReady })];
      const [exact, preview] = s.heights_mm ?? [];
      const rows = [
        ["Distance, root mean square", `${mm((s.rms_percent / 100) * s.diameter_mm, 2)} (${percent(s.rms_percent)})`],
        ["Largest distance", mm((s.max_percent / 100) * s.diameter_mm, 2)],
        ["Exact height", mm(exact)],
        ["Preview's height", mm(preview)],
        ["Exact model took", seconds(s.exact_s)],
      ];
      const said = new Set(store.get("state").warnings?.map(({ text }) => text));
      return [
        old,
        figures(rows.filter(([, value]) => !value.startsWith("–")), "verified"),
        h("div.row.wrap", [result.report && fileLink(result.report, "report", "Report"), go("Verify again")]),
        warningList((s.warnings ?? []).filter((text) => !said.has(text)).map(capital)),
      ];
    },
  });
}

/** How much prints of the design differ from its exact shape. */
export const spreadPart = (studio) =>
  jobPart(studio, {
    job: "spread",
    title: "How much prints differ",
    testid: "spread",
    about: () => ({ isExact: studio.store.get("badge").kind === "exact" }),
    found(result, { isExact }, old) {
      const go = (text, rest) =>
        button({ text, testid: "spread-go", disabled: !isExact, onclick: studio.actions.spread, ...rest });
      const about = "Ten exact shapes tell what nobody knows exactly, such as the stretch, is worth.";
      if (!result?.summary) return [hint(about), go("Range of prints", { kind: "wide" })];
      const [file] = result.files;
      const row = ([name, text]) => h("p", h("b", `${capital(name)}: `), text);
      const rows = Object.entries(result.summary.rows).map(row);
      return [
        old,
        h("div", { testid: "spread-found" }, rows),
        h("div.row.wrap", [file && fileLink(file.name, "camera", "Picture"), go("Compute again")]),
        warningList(result.warnings.map(capital)),
      ];
    },
  });

/** A fit of outline, stars and supports to the target. */
export function fitPart(studio) {
  const { store, actions } = studio;
  let hold = "auto";
  return jobPart(studio, {
    job: "fit",
    title: "Fit to the target",
    testid: "fit",
    about() {
      const { target } = store.get("state");
      return target ? { name: target.name } : null;
    },
    found(result, _, old) {
      const about = result?.cancelled
        ? "Cancelled. The design is unchanged."
        : "Finds outline, stars and supports whose sheet comes near to the target. It replaces those of the design in one step, which Undo takes back, and runs beside your work.";
      const held = choice({
        label: "What holds the sheet",
        testid: "fit-hold",
        options: HOLDS,
        value: hold,
        onchange: (value) => (hold = value),
      });
      const isBusy = Object.keys(store.get("jobs")).length > 0;
      return [
        result?.summary ? fitted(result.summary, old) : hint(about),
        labelled("Held", held),
        wide("Paint where it comes nearer", "fit-weights", () => actions.choose("weight")),
        wide(result?.summary ? "Fit again" : "Fit to the target", "fit-go", () => actions.fitToTarget(hold), {
          disabled: isBusy,
        }),
      ];
    },
  });
}

/** What a fit came to. */
function fitted(s, old) {
  const rows = [
    ["Distance by the preview, rms", `${percent(s.preview.mean_percent, 2)} of the diameter`],
    ...(s.preview.weighted_percent === s.preview.mean_percent
      ? []
      : [["The same by the weights", percent(s.preview.weighted_percent, 2)]]),
    ["Largest distance", percent(s.preview.largest_percent, 1)],
    ["Stars", String(s.stars)],
    ["Held by", s.held_border ? "the border" : s.needles ? plural(s.needles, "needle") : "nothing"],
    ["Uneven shrinking, needed", `×${s.needed_ratio.toFixed(2)}`],
    ["Uneven shrinking, possible", `×${s.available_ratio.toFixed(2)}`],
    ["Added by printable layers and lines", s.rounding_loss_percent === null ? "–" : percent(s.rounding_loss_percent, 2)],
  ];
  return [figures(rows, "fit-numbers"), ...s.warnings.map((line) => hint(capital(line))), old];
}
