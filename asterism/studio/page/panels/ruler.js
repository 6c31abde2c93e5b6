// Panel of the ruler: the distance on the print, and on the released fabric.

import { figureRows, h, hint, replace, section } from "../dom.js";
import { mm } from "../format.js";
import { stretchOf } from "../sheet.js";

export function rulerPanel({ store }, { on }) {
  const list = h("dl", { class: "figures", testid: "measured" });
  const empty = hint("Drag in the plan from one place to another.");
  function update() {
    const measured = store.get("measured");
    empty.hidden = Boolean(measured);
    if (!measured) return replace(list);
    const [sx, sy] = stretchOf(store.get("sheet").design);
    const [[ax, ay], [bx, by]] = measured.line;
    const rows = [
      ["On the print", measured.printed],
      ["Across, x", Math.abs(bx - ax)],
      ["Upwards, y", Math.abs(by - ay)],
      ["Released fabric without stars", Math.hypot((bx - ax) / sx, (by - ay) / sy)],
    ];
    replace(list, figureRows(rows.map(([name, value]) => [name, mm(value)])));
  }
  on(["measured"], update);
  update();
  return [section("Distance"), empty, list];
}
