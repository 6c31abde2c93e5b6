// The line at the bottom: state of the shape, height, size, warnings, what is under the pointer.

import { button, h, replace } from "../dom.js";
import { MEANINGS, activityOf, dotOf } from "../badge.js";
import { mm, plural, seconds, size, times } from "../format.js";

export function buildStatus(element, { store, actions }) {
  const engine = h("span", { testid: "engine", role: "status" });
  const height = h("span", { testid: "height" });
  const extent = h("span", { testid: "extent" });
  const stars = h("span", { testid: "stars" });
  const said = h("span", { testid: "job", role: "status" });
  const cancel = button({ text: "Cancel", keys: "Escape", kind: "plain", testid: "cancel", onclick: actions.cancel });
  const job = h("span", { class: "job", hidden: true }, said, cancel);
  const place = h("span", { testid: "under" });
  const warnings = h("button", {
    type: "button",
    class: "button plain",
    testid: "warnings",
    onclick: () => actions.showPage("shape"),
  });
  element.append(engine, height, extent, stars, job, h("span", { class: "gap" }), place, warnings);

  function update() {
    const { numbers = {}, warnings: all = [] } = store.get("state");
    const frame = store.get("frame");
    const document = store.get("document");
    const badge = store.get("badge");
    const activity = activityOf({
      state: store.get("state"),
      connection: store.get("connection"),
      document,
    });
    replace(
      engine,
      h("i", { class: `dot ${dotOf(badge, activity)}`, "aria-hidden": "true" }),
      h("b", { testid: "footer-state" }, badge.words),
      activity ? `  ${activity}` : "",
    );
    engine.title = MEANINGS[badge.kind];
    for (const one of [height, extent]) one.classList.toggle("stale", Boolean(badge.isStale));
    const isDrawn = Boolean(document && frame);
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
    if (running) replace(said, h("i", { class: "dot busy", "aria-hidden": "true" }), running);
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
  store.on(["state", "badge", "frame", "document", "connection", "sheet", "jobs"], update);
  store.on(["hover", "selection", "sheet"], under);
  update();
  under();
}

const JOBS = {
  verify: "Verifying",
  fit: "Fitting to the target",
  export: "Writing files",
  report: "Writing the report",
  animate: "Drawing the release",
  spread: "Computing the range of prints",
};

function jobText(jobs) {
  const [name, { done, of, stage, seconds: spent } = {}] = Object.entries(jobs)[0] ?? [];
  if (!name) return null;
  return `${JOBS[name]}, ${of ? `${Math.round((100 * done) / of)} %` : `${stage} …`} ${seconds(spent)}`;
}
