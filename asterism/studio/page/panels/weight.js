// Panel of the brush of weights: where a fit comes nearer to the target.

import { button, h, hint, refresh } from "../dom.js";
import { plural } from "../format.js";
import { STRONG } from "../plan/weights.js";
import { brushParts, symmetry } from "./brush.js";

const MODES = {
  paint: {
    text: "Paint",
    title: "Paint a weight",
    says: "A place of weight 10 counts ten times as much in the fit. Other places come out further away.",
  },
  erase: { text: "Erase", title: "Erase weights", says: "Places without a weight count once." },
};

export function weightPanel({ store, actions, edits }, { on }) {
  const parts = brushParts({ store }, { setting: "weightBrush", modes: MODES, prefix: "weight-" });
  const { brush, mode, says, field, radius, strength } = parts;
  // the design file allows more
  const weight = field("Weight", "weight", { testid: "weight", unit: "×", step: 0.1, digits: 2, min: 0.1, max: STRONG });
  const below = h("div", {});

  function update() {
    parts.update();
    weight.set(brush().weight);
    weight.element.hidden = strength.element.hidden = brush().mode === "erase";
    const weighed = store.get("sheet")?.stars.filter((star) => star.weight !== 1).map((star) => star.key) ?? [];
    const { target } = store.get("state");
    refresh(below, [weighed, Boolean(target), Boolean(store.get("document"))], () => [
      hint(weighed.length ? `${plural(weighed.length, "star")} with a weight.` : "All places count alike."),
      button({
        text: "Erase all weights",
        kind: "wide",
        testid: "weight-clear",
        disabled: !weighed.length,
        onclick: () => edits.once(() => edits.weigh(new Map(weighed.map((key) => [key, null])))),
      }),
      target
        ? button({ text: "To the fit", kind: "wide", testid: "weight-fit", onclick: () => actions.showPage("shape") })
        : hint("Weights count in the fit to a target. Load one on the page Shape."),
    ]);
  }
  on(["weightBrush", "sheet", "state", "document"], update);
  update();
  return [mode.element, says, weight.element, radius.element, strength.element, below, ...symmetry({ store }, { on })];
}
