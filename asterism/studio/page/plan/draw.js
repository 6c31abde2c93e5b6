// Draws the plan: paper, millimetre grid, printable area, stars and rods to scale, supports, selection, scale bar.

import { ramp, rampDomain } from "../view/colours.js";
import { QUANTITIES, fixed } from "../format.js";
import { nice } from "../geometry.js";
import { drawPrintArea, tooLarge } from "./print_area.js";
import { drawSupports } from "./supports.js";
import { disc, polyline, segments, stroke } from "./tools/common.js";
import { drawWeights } from "./weights.js";

export function drawPlan(context, plan) {
  const { canvas, store } = plan;
  const sheet = store.get("sheet");
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const paint = { context, plan, sheet, store, colour };
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  if (sheet.printer && (store.get("printArea") || tooLarge(sheet))) drawPrintArea(paint);
  drawPaper(paint);
  drawWeights(paint);
  drawRods(paint);
  drawStars(paint);
  drawSupports(paint);
  plan.tool?.draw?.(context, plan, colour);
  drawMarks(paint);
  drawScaleBar(paint);
  drawSizeLegend(paint);
  drawHatchLegend(paint);
}

/** The outline and the edges of the holes, as one path. */
function sheetPath(paint) {
  polyline(paint.context, paint.plan, paint.sheet.outline, true);
  for (const hole of paint.sheet.holes) {
    hole.forEach((point, k) => paint.context[k ? "lineTo" : "moveTo"](...paint.plan.toScreen(point)));
    paint.context.closePath();
  }
}

function drawPaper(paint) {
  const { context, store, colour } = paint;
  sheetPath(paint);
  context.fillStyle = colour("paper");
  context.fill("evenodd");
  if (store.get("grid")) {
    context.save();
    context.clip("evenodd");
    drawGrid(paint);
    context.restore();
  }
  sheetPath(paint);
  context.lineJoin = "round";
  stroke(context, { colour: colour("ink"), width: 1.5 });
}

/** Lines every 10 mm (1, 2 or 5 mm where there is room), every tenth stronger. */
function drawGrid({ context, plan, sheet, colour }) {
  const step = nice(14 / plan.scale);
  const { low, high } = sheet.box;
  for (const axis of [0, 1]) {
    for (let k = Math.ceil(low[axis] / step); k * step <= high[axis]; k++) {
      const end = (corner) => plan.toScreen(corner.with(axis, k * step)).map((value) => Math.round(value) + 0.5);
      segments(context, [[end(low), end(high)]]);
      stroke(context, { colour: colour(k % 5 === 0 ? "grid-strong" : "grid") });
    }
  }
}

/** Viridis without the end that vanishes on this paper. */
function sizeColour(share) {
  const isDark = getComputedStyle(document.documentElement).colorScheme.trim() === "dark";
  return ramp("viridis", isDark ? 0.24 + 0.76 * share : 0.86 * share);
}

function drawStars(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const quantity = store.get("planColour");
  const entry = QUANTITIES[quantity];
  const domain = entry && rampDomain(sheet.values(quantity));
  const ink = colour("ink");
  context.lineCap = "round";
  for (const star of sheet.stars) {
    const [x, y] = plan.toScreen(star.at);
    if (!star.isPrinted || star.isOffSheet) {
      drawVacant(paint, star, x, y);
      continue;
    }
    if (sheet.isOutsideLaw(star)) drawOutsideLaw(paint, star);
    context.strokeStyle = entry ? sizeColour((star.sizes[entry.column] - domain[0]) / (domain[1] - domain[0])) : ink;
    context.globalAlpha = star.isReset ? 0.45 : 1;
    context.lineWidth = Math.max(1, star.sizes[2] * plan.scale);
    segments(context, star.arms.map((arm) => arm.map((end) => plan.toScreen(end))));
    context.stroke();
    context.globalAlpha = 1;
  }
}

/** Drawn rods to scale, piece by piece where their sections change. */
function drawRods(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const quantity = store.get("planColour");
  const key = sheet.rods.length && quantity in QUANTITIES && quantity !== "length" && QUANTITIES[quantity].key;
  const domain = key && rampDomain(sheet.values(quantity));
  context.lineCap = context.lineJoin = "round";
  for (const { points_mm: points, thickness_mm: thickness, width_mm: width } of sheet.rods) {
    const places = points.map((point) => plan.toScreen(point));
    const isEven = [thickness, width].every((values) => values.every((value) => value === values[0]));
    for (let from = 0; from < points.length - 1; from += isEven ? points.length : 1) {
      const shown = isEven ? places : places.slice(from, from + 2);
      const mean = (values) => (isEven ? values[0] : (values[from] + values[from + 1]) / 2);
      const value = key && mean(key === "width_mm" ? width : thickness);
      context.strokeStyle = key ? sizeColour((value - domain[0]) / (domain[1] - domain[0])) : colour("ink");
      context.lineWidth = Math.max(1, mean(width) * plan.scale);
      context.beginPath();
      shown.forEach((place, k) => context[k ? "lineTo" : "moveTo"](...place));
      context.stroke();
    }
  }
}

/** A small cross where a star was removed, a dot where its arms are too short to print. */
function drawVacant({ context, plan, colour }, star, x, y) {
  const reach = Math.max(2, Math.min(4, plan.scale));
  if (star.removed) {
    const corner = (a, b) => [x + a * reach, y + b * reach];
    segments(context, [[corner(-1, -1), corner(1, 1)], [corner(1, -1), corner(-1, 1)]]);
    stroke(context, { colour: colour("ink-soft") });
  } else {
    disc(context, [x, y], 1.5);
    context.fillStyle = colour("ink-soft");
    context.fill();
  }
}

/** Hatching: this star's size is outside the range for which the law was calibrated. */
function drawOutsideLaw(paint, star) {
  hatch(paint, paint.plan.toScreen(star.at), 0.46 * paint.sheet.spacing * paint.plan.scale);
}

/** What the hatching means, where there is any. */
function drawHatchLegend(paint) {
  const { plan, sheet, store } = paint;
  if (!sheet.stars.some((star) => !star.isOffSheet && sheet.isOutsideLaw(star))) return;
  const [x, y] = [23, plan.canvas.clientHeight - (QUANTITIES[store.get("planColour")] ? 108 : 48)];
  hatch(paint, [x, y], 7);
  label(paint, "outside the calibrated range", [x + 14, y + 4], "left", "warn");
}

function hatch({ context, colour }, [x, y], radius) {
  context.save();
  disc(context, [x, y], radius);
  context.clip();
  const lines = [];
  for (let k = -radius; k <= radius; k += 5) lines.push([[x + k - radius, y + radius], [x + k + radius, y - radius]]);
  segments(context, lines);
  stroke(context, { colour: colour("warn"), alpha: 0.8 });
  context.restore();
}

/** Selection, hover and keyboard star, warnings' ring. */
function drawMarks(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const radius = Math.max(6, 0.5 * sheet.spacing * plan.scale - 2);
  const accent = colour("accent");
  const ring = (star, width, dash) => {
    disc(context, plan.toScreen(star.at), radius);
    stroke(context, { colour: accent, width, dash });
  };
  const isQuiet = !["select", "brush"].includes(store.get("tool"));
  for (const key of store.get("selection")) {
    const star = sheet.byKey.get(key);
    if (!star) continue;
    disc(context, plan.toScreen(star.at), radius);
    context.fillStyle = accent;
    context.globalAlpha = isQuiet ? 0.06 : 0.14;
    context.fill();
    context.globalAlpha = 1;
    if (!isQuiet) ring(star, 1.5);
  }
  const hover = sheet.byKey.get(store.get("hover"));
  if (hover) ring(hover, 1, [3, 3]);
  const cursor = sheet.byKey.get(store.get("cursor"));
  if (cursor && document.activeElement === plan.canvas && !("pointer" in plan.canvas.dataset)) ring(cursor, 3);
  if (plan.pulse) drawPulse(paint);
}

function drawPulse({ context, plan, colour }) {
  const { at, start, duration, still } = plan.pulse;
  const part = still ? 0.5 : (((performance.now() - start) / duration) * 2) % 1;
  disc(context, plan.toScreen(at), 10 + 22 * part);
  stroke(context, { colour: colour("warn"), width: 3, alpha: 1 - 0.8 * part });
}

function drawScaleBar(paint) {
  const { context, plan, colour } = paint;
  const length = nice(70 / plan.scale);
  const [x, y] = [16, plan.canvas.clientHeight - 16];
  const end = x + length * plan.scale;
  segments(context, [[[x, y - 4], [x, y + 4]], [[x, y], [end, y]], [[end, y - 4], [end, y + 4]]]);
  stroke(context, { colour: colour("muted"), width: 1.5 });
  label(paint, `${Number(length.toPrecision(2))} mm`, [x, y - 10], "left", "muted");
}

/** The colours of the sizes of stars and rods, from the least to the largest. */
function drawSizeLegend(paint) {
  const { context, plan, sheet, store } = paint;
  const entry = QUANTITIES[store.get("planColour")];
  const values = entry ? sheet.values(store.get("planColour")) : [];
  if (!values.length) return;
  const [low, high] = rampDomain(values);
  const [x, y] = [16, plan.canvas.clientHeight - 70];
  for (let k = 0; k < 96; k++) {
    context.fillStyle = sizeColour(k / 95);
    context.fillRect(x + k, y, 1.5, 8);
  }
  label(paint, `${entry.name}, mm`, [x, y - 8], "left", "muted");
  label(paint, fixed(low, entry.digits), [x, y + 22], "left", "muted");
  label(paint, fixed(high, entry.digits), [x + 96, y + 22], "right", "muted");
}

/** A text with a halo, kept within the canvas. */
export function label({ context, colour }, text, [left, y], align = "left", name = "text") {
  context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  const room = context.canvas.clientWidth - 8 - context.measureText(text).width;
  const x = align === "left" ? Math.max(8, Math.min(left, room)) : left;
  context.textAlign = align;
  context.textBaseline = "alphabetic";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = colour("paper");
  context.globalAlpha = 0.85;
  context.strokeText(text, x, y);
  context.globalAlpha = 1;
  context.fillStyle = colour(name);
  context.fillText(text, x, y);
}
