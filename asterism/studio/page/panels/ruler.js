// Panel of the ruler: the distance on the print, and on the released fabric.

import { figures, follow, hint, part, section } from "../dom.js";
import { mm } from "../format.js";
import { stretchOf } from "../sheet.js";

export function rulerPanel({ store }, { on }) {
  const measured = () => store.get("measured");
  return follow(on, ["measured"], [
    section("Distance"),
    part(null, measured, (known) => {
      if (!known) return hint("Drag in the plan from one place to another.");
      const [sx, sy] = stretchOf(store.get("sheet").design);
      const [[ax, ay], [bx, by]] = known.line;
      const rows = [
        ["On the print", known.printed],
        ["Across, x", Math.abs(bx - ax)],
        ["Upwards, y", Math.abs(by - ay)],
        ["Released fabric without stars", Math.hypot((bx - ax) / sx, (by - ay) / sy)],
      ];
      return figures(rows.map(([name, value]) => [name, mm(value)]), "measured");
    }),
  ]);
}
