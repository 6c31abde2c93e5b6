// Needles and held edges in the plan, and where they take the sheet.

import { fixed } from "../format.js";
import { membersOf, pointsOf, targetsOf } from "../supports.js";
import { label } from "./draw.js";
import { disc, segments, stroke } from "./tools/common.js";

export function drawSupports(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const chosen = membersOf(store.get("support"));
  const isTool = store.get("tool") === "needles";
  sheet.tables.forEach((table, number) => {
    const shown = sheet.pins[number];
    for (const [a, b] of shown?.edges ?? []) drawHeldEdge(paint, a, b);
    const points = pointsOf(table, shown);
    const targets = targetsOf(table, shown);
    points.forEach((point, k) => {
      const isChosen = chosen.some(({ table: one, point: at }) => one === number && (at === k || at === null));
      const place = targets[k];
      const [x, y] = plan.toScreen(point);
      if (isTool && place) drawTarget(paint, [x, y], plan.toScreen(place), isChosen);
      disc(context, [x, y], isChosen ? 6.5 : 5);
      context.fillStyle = colour("needle");
      context.fill();
      stroke(context, { colour: colour(isChosen ? "accent" : "paper"), width: 2 });
      if (isTool && place?.[2]) label(paint, `z ${fixed(place[2])}`, [x + 9, y - 7], "left", "needle");
    });
  });
}

/** Where a needle takes its point: a thin line and a cross. */
function drawTarget({ context, colour }, from, to, isChosen) {
  const pen = { colour: colour("needle"), alpha: isChosen ? 1 : 0.6 };
  segments(context, [[from, to]]);
  stroke(context, { ...pen, dash: [3, 3] });
  const [x, y] = to;
  segments(context, [[[x - 4, y], [x + 4, y]], [[x, y - 4], [x, y + 4]]]);
  stroke(context, { ...pen, width: 1.5 });
}

function drawHeldEdge(paint, a, b) {
  const { context, plan, colour } = paint;
  const [from, to] = [plan.toScreen(a), plan.toScreen(b)];
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (length < 1) return;
  const along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  const out = [-along[1], along[0]];
  segments(context, [[from, to]]);
  stroke(context, { colour: colour("needle"), width: 2.5 });
  const barbs = [];
  for (let k = 4; k < length; k += 8) {
    const [x, y] = [from[0] + k * along[0], from[1] + k * along[1]];
    barbs.push([[x, y], [x + 5 * (out[0] - along[0] * 0.7), y + 5 * (out[1] - along[1] * 0.7)]]);
  }
  segments(context, barbs);
  stroke(context, { colour: colour("needle") });
}
