// Needles and held edges in the plan, and where they take the sheet.

import { fixed } from "../format.js";
import { membersOf, pointsOf, targetsOf } from "../supports.js";
import { label } from "./draw.js";

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
      context.beginPath();
      context.arc(x, y, isChosen ? 6.5 : 5, 0, 2 * Math.PI);
      context.fillStyle = colour("needle");
      context.fill();
      context.lineWidth = 2;
      context.strokeStyle = isChosen ? colour("accent") : colour("paper");
      context.stroke();
      if (isTool && place?.[2]) label(paint, `z ${fixed(place[2])}`, [x + 9, y - 7], "left", "needle");
    });
  });
}

/** Where a needle takes its point: a thin line and a cross. */
function drawTarget({ context, colour }, from, to, isChosen) {
  context.strokeStyle = colour("needle");
  context.globalAlpha = isChosen ? 1 : 0.6;
  context.lineWidth = 1;
  context.setLineDash([3, 3]);
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
  context.setLineDash([]);
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(to[0] - 4, to[1]);
  context.lineTo(to[0] + 4, to[1]);
  context.moveTo(to[0], to[1] - 4);
  context.lineTo(to[0], to[1] + 4);
  context.stroke();
  context.globalAlpha = 1;
}

function drawHeldEdge(paint, a, b) {
  const { context, plan, colour } = paint;
  const [from, to] = [plan.toScreen(a), plan.toScreen(b)];
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (length < 1) return;
  const along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  const out = [-along[1], along[0]];
  context.strokeStyle = colour("needle");
  context.lineWidth = 2.5;
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
  context.lineWidth = 1;
  context.beginPath();
  for (let k = 4; k < length; k += 8) {
    const [x, y] = [from[0] + k * along[0], from[1] + k * along[1]];
    context.moveTo(x, y);
    context.lineTo(x + 5 * (out[0] - along[0] * 0.7), y + 5 * (out[1] - along[1] * 0.7));
  }
  context.stroke();
}
