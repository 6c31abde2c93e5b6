// Part of the shape's panel: a fit of outline, stars and supports to the target, beside the work.

import { button, choice, h, hint, refresh, section } from "../dom.js";
import { capital, percent, plural } from "../format.js";

const HOLDS = { auto: "By the target", border: "Whole border", nothing: "Nothing" };

export function fitPart({ store, actions }, { on }) {
  const element = h("div", { testid: "fit" });
  const ended = h("div", {});
  element.append(ended);
  let hold = "auto";

  function update() {
    const { target } = store.get("state");
    const jobs = store.get("jobs");
    ended.hidden = Boolean(jobs.fit) || !target;
    const { fit: result } = store.get("results");
    const isOld = result?.summary && result.revision !== store.get("document")?.revision;
    const isBusy = Object.keys(jobs).length > 0; // one job runs at a time
    refresh(ended, [target?.name, result, isOld, isBusy], () => [
      section("Fit to the target"),
      ...(result?.summary ? numbers(result.summary, isOld) : [hint(about(result))]),
      h("div", { class: "field" }, h("label", {}, "Held"), holdChoice().element),
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
        disabled: isBusy,
        onclick: () => actions.fitToTarget(hold),
      }),
    ]);
  }

  const holdChoice = () =>
    choice({
      label: "What holds the sheet",
      testid: "fit-hold",
      options: Object.entries(HOLDS).map(([value, text]) => ({ value, text })),
      value: hold,
      onchange: (value) => (hold = value),
    });

  on(["jobs", "results", "state", "document"], update);
  update();
  return element;
}

function about(result) {
  if (result?.cancelled) return "Cancelled. The design is unchanged.";
  return "Finds outline, stars and supports whose sheet comes near to the target. It replaces those of the design in one step, which Undo takes back, and runs beside your work.";
}

/** What a fit came to. */
function numbers(s, isOld) {
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
  return [
    h(
      "dl",
      { class: "figures", testid: "fit-numbers" },
      rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]),
    ),
    ...s.warnings.map((line) => h("p", { class: "hint" }, capital(line))),
    isOld ? hint("The design has changed since.") : null,
  ];
}
