// Panel of the brush of weights: where a fit comes nearer to the target.

import { follow, hint, part, wide } from "../dom.js";
import { plural } from "../format.js";
import { STRONG } from "../plan/draw.js";
import { brushParts, symmetry } from "./brush.js";

const MODES = {
  paint: {
    text: "Paint",
    title: "Paint a weight",
    says: "A place of weight 10 counts ten times as much in the fit. Other places come out further away.",
  },
  erase: { text: "Erase", title: "Erase weights", says: "Places without a weight count once." },
};

export function weightPanel(studio, { on }) {
  const { store, actions, edits } = studio;
  const { brush, mode, says, field } = brushParts(studio, { setting: "weightBrush", modes: MODES, prefix: "weight-" });
  const hidden = () => brush().mode === "erase";
  // the design file allows more
  const limits = { min: 0.1, max: STRONG, step: 0.1, digits: 2 };
  const erase = (keys) => edits.once(() => edits.weigh(new Map(keys.map((key) => [key, null]))));
  const weighed = () => store.get("sheet")?.stars.filter((star) => star.weight !== 1).map((star) => star.key) ?? [];
  return [
    follow(on, ["weightBrush", "sheet", "state"], [
      mode,
      says,
      field("Weight", "weight", { testid: "weight", unit: "×", ...limits, hidden }),
      field("Radius", "radius"),
      field("Strength", "strength", { hidden }),
      part(null, () => [weighed(), Boolean(store.get("state").target)], ([keys, hasTarget]) => [
        hint(keys.length ? `${plural(keys.length, "star")} with a weight.` : "All places count alike."),
        wide("Erase all weights", "weight-clear", () => erase(keys), { disabled: !keys.length }),
        hasTarget
          ? wide("To the fit", "weight-fit", () => actions.showPage("shape"))
          : hint("Weights count in the fit to a target. Load one on the page Shape."),
      ]),
    ]),
    symmetry(studio, { on }),
  ];
}
