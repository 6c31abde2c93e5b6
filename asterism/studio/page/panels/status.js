// The line at the bottom: state of the shape, height, size, warnings, what is under the pointer.

import { append, button, follow, h, part, show } from "../dom.js";
import { MEANINGS, activityOf, dotOf } from "../badge.js";
import { mm, plural, seconds, size, sizesOf, times } from "../format.js";

export function buildStatus(element, { store, actions }) {
  const badge = () => store.get("badge");
  const [state, connection, document] = ["state", "connection", "document"].map((key) => () => store.get(key));
  const activity = () => activityOf({ state: state(), connection: connection(), document: document() });
  const className = () => (badge().isStale ? "stale" : "");
  const numbers = () => state().numbers ?? {};
  const extent = () => (numbers().extent_mm ? size(numbers().extent_mm) : "–");
  function height() {
    const frame = document() && store.get("frame");
    return frame ? mm(numbers().height_mm ?? frame.height_mm) : "–";
  }
  function pattern() {
    const sheet = store.get("sheet");
    if (!sheet) return "No sheet";
    const [stars, rods] = [sheet.printed.length, sheet.rods.length];
    return [stars || !rods ? plural(stars, "star") : "", rods ? plural(rods, "rod") : ""].filter(Boolean).join(", ");
  }
  const warnings = () => state().warnings?.length ?? 0;
  const job = jobClock(store);
  const dot = () => `dot ${dotOf(badge(), activity())}`;
  const line = follow(store.on, ["state", "badge", "frame", "document", "connection", "sheet", "jobs"], [
    h("span", { testid: "engine", role: "status", title: () => MEANINGS[badge().kind] }, [
      h("i", { className: dot, "aria-hidden": "true" }),
      h("b", { testid: "footer-state" }, () => badge().words),
      h("span", { "aria-live": () => (state().settling ? "off" : "polite") }, () => (activity() ? `  ${activity()}` : "")),
    ]),
    h("span", { testid: "height", className }, "Height ", h("b", height)),
    h("span", { testid: "extent", className }, "Size ", h("b", extent)),
    h("span", { testid: "stars" }, pattern),
    h("span.job", { hidden: () => !job() }, [
      h("span", { testid: "job", role: "status" }, [
        h("i.dot.busy", { "aria-hidden": "true" }),
        h("span", () => job() ?? ""),
      ]),
      button({ text: "Cancel", keys: "Escape", kind: "plain", testid: "cancel", onclick: actions.cancel }),
    ]),
    h("span.gap"),
  ]);
  setInterval(() => (job() || state().settling) && show(line), 1000);
  const place = part("under", () => under(store), ([words, sizes]) => [words, sizes && h("b", sizes)]);
  const onclick = () => {
    actions.showPage("shape");
    globalThis.document.querySelector("[data-testid=warning-list]")?.scrollIntoView({ block: "center" });
  };
  const go = { type: "button", testid: "warnings", hidden: () => !warnings(), onclick };
  const warned = h("button.button.plain", go, h("b", () => plural(warnings(), "warning")));
  follow(store.on, ["hover", "selection", "sheet"], place);
  follow(store.on, ["state"], warned);
  append(element, [line, place, warned]);
}

/** The star under the pointer, or what is selected, in words, and the star's sizes. */
function under(store) {
  const star = store.get("sheet")?.byKey.get(store.get("hover"));
  const chosen = store.get("selection").size;
  if (!star) return [chosen ? `${plural(chosen, "star")} selected` : ""];
  const absent = star.removed ? "removed" : "no star here";
  const sizes = star.isPrinted ? sizesOf(star, ({ is }, size) => `${size} ${is}`) : absent;
  const weight = star.weight === 1 ? "" : `, weight ${times(star.weight)}`;
  return [`Star ${star.row} at ${star.at[0].toFixed(1)}, ${star.at[1].toFixed(1)} mm: `, sizes + weight];
}

const JOBS = {
  verify: "Verifying",
  fit: "Fitting to the target",
  export: "Writing files",
  report: "Writing the report",
  animate: "Drawing the release",
  spread: "Computing the range of prints",
};

const BEGINNINGS = ["starts", "starting"]; // stages that say no more than the name of the job

/** What the running job does, and for how long. Between two messages of the server the page counts on by itself. */
function jobClock(store) {
  let running = null;
  let begun = 0;
  return () => {
    const [name = null, progress = {}] = Object.entries(store.get("jobs"))[0] ?? [];
    const { done, of, stage, seconds: said } = progress;
    const now = performance.now() / 1000;
    if (name !== running) [running, begun] = [name, now - said];
    if (!name) return null;
    const way = of ? `${Math.round((100 * done) / of)} %` : [...BEGINNINGS, name].includes(stage) ? "" : `${stage} …`;
    return `${[JOBS[name], way].filter(Boolean).join(", ")}${way ? "" : " …"} ${seconds(Math.max(said, now - begun))}`;
  };
}
