// Weights of places in a fit, as discs under the stars: the darker, the nearer the fit comes there.

import { clamp } from "../geometry.js";
import { disc, polyline, stroke } from "./tools/common.js";

export const STRONG = 20; // weights from here on have the full colour
const LEAST_ALPHA = 0.1;
const MOST_ALPHA = 0.55;

export function drawWeights({ context, plan, sheet, colour }) {
  const weighed = sheet.stars.filter((star) => star.weight !== 1 && !star.isOffSheet);
  if (!weighed.length) return;
  const radius = 0.5 * sheet.spacing * plan.scale;
  context.save();
  polyline(context, plan, sheet.outline, true);
  context.clip();
  context.fillStyle = colour("weight");
  for (const star of weighed) {
    disc(context, plan.toScreen(star.at), Math.max(2, radius - 1));
    if (star.weight < 1) {
      stroke(context, { colour: colour("weight"), width: 1.5, dash: [2, 4] }); // such a place counts less
      continue;
    }
    const share = clamp(Math.log(star.weight) / Math.log(STRONG), 0, 1);
    context.globalAlpha = LEAST_ALPHA + share * (MOST_ALPHA - LEAST_ALPHA);
    context.fill();
    context.globalAlpha = 1;
  }
  context.restore();
}
