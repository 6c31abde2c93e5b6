// The line at the bottom: engine, estimated error, height, size, warnings, what is under the pointer.

import { h, replace } from "../dom.js";
import { isLong } from "../store.js";
import { capital, mm, percent, plural, size, times, trust } from "../format.js";

export function buildStatus(element, { store, actions }) {
  const engine = h("span", { testid: "engine", role: "status" });
  const error = h("span", { testid: "expected" });
  const height = h("span", { testid: "height" });
  const extent = h("span", { testid: "extent" });
  const stars = h("span", { testid: "stars" });
  const job = h("span", { testid: "job", role: "status", hidden: true });
  const place = h("span", { testid: "under" });
  const warnings = h("button", {
    type: "button",
    class: "button plain",
    testid: "warnings",
    onclick: () => actions.showPage("shape"),
  });
  element.append(engine, error, height, extent, stars, job, h("span", { class: "gap" }), place, warnings);

  function update() {
    const { numbers = {}, warnings: all = [] } = store.get("state");
    const frame = store.get("frame");
    const document = store.get("document");
    const [words, kind] = engineText(store);
    replace(engine, h("i", { class: `dot ${kind}`, "aria-hidden": "true" }), words);
    const isStale = store.get("state").summary_revision !== document?.revision;
    for (const one of [error, extent]) one.classList.toggle("stale", isStale);
    const isDrawn = Boolean(document && frame);
    const expected = numbers.expected_rms_percent;
    replace(error, "Estimated error ", h("b", {}, Number.isFinite(expected) ? percent(expected) : "–"));
    error.title = `${trust(expected).words}. Root mean square distance to the exact shape, in percent of the diameter.`;
    replace(height, "Height ", h("b", {}, isDrawn ? mm(numbers.height_mm ?? frame.height_mm) : "–"));
    replace(extent, "Size ", h("b", {}, numbers.extent_mm ? size(numbers.extent_mm) : "–"));
    const sheet = store.get("sheet");
    const counts = [
      ...(sheet?.printed.length || !sheet?.rods.length ? [plural(sheet?.printed.length ?? 0, "star")] : []),
      ...(sheet?.rods.length ? [plural(sheet.rods.length, "rod")] : []),
    ];
    replace(stars, sheet ? counts.join(", ") : "No sheet");
    const running = jobText(store.get("jobs"));
    job.hidden = !running;
    if (running) replace(job, h("i", { class: "dot busy", "aria-hidden": "true" }), running);
    warnings.hidden = !all.length;
    replace(warnings, h("b", {}, plural(all.length, "warning")));
  }
  function under() {
    const sheet = store.get("sheet");
    const star = sheet?.byKey.get(store.get("hover"));
    const chosen = store.get("selection").size;
    if (star) {
      const [length, thickness, width] = star.sizes;
      const sizes = star.isPrinted
        ? `${mm(length)} long, ${mm(thickness, 2)} thick, ${mm(width, 2)} wide`
        : star.removed
          ? "removed"
          : "no star here";
      const weight = star.weight === 1 ? "" : `, weight ${times(star.weight)}`;
      replace(place, `Star ${star.row} at ${star.at[0].toFixed(1)}, ${star.at[1].toFixed(1)} mm: `, h("b", {}, sizes + weight));
    } else replace(place, chosen ? `${plural(chosen, "star")} selected` : "");
  }
  store.on(["state", "frame", "document", "connection", "sheet", "jobs"], update);
  store.on(["hover", "selection", "sheet"], under);
  update();
  under();
}

const SEARCHES = {
  flip: "Searching for the other side, Esc cancels",
  form: "Searching for the other form, Esc cancels",
};
const JOBS = { verify: "Verifying", fit: "Fitting to the target", export: "Writing files", report: "Writing the report" };

function jobText(jobs) {
  const [name, progress] = Object.entries(jobs)[0] ?? [];
  if (!name) return null;
  return `${JOBS[name] ?? name}${progress.of ? `, ${Math.round((100 * progress.done) / progress.of)} %` : " …"}`;
}

function engineText(store) {
  if (store.get("connection") === "lost") return ["Connection lost, trying again", "bad"];
  if (store.get("connection") === "connecting") return ["Connecting", "busy"];
  const { engine, busy, stage, searching } = store.get("state");
  if (!store.get("document"))
    return [engine === "starting" ? "Engine starts" : "Ready", engine === "starting" ? "busy" : ""];
  if (searching) return [SEARCHES[searching], "busy"];
  if (busy) return [isLong(store.get("state")) ? `${capital(busy)}, Esc cancels` : capital(busy), "busy"];
  if (engine === "starting") return ["Engine starts", "busy"];
  if (engine === "computing") return ["Computing", "busy"];
  if (engine === "failed") return ["Engine restarts", "bad"];
  if (store.get("state").problem?.kind === "no preview") return ["Shown as printed", ""];
  return [{ linear: "First estimate", exact: "Exact shape" }[stage] ?? "In equilibrium", ""];
}
