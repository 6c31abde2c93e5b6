// Draws the plan: paper, millimetre grid, printable area, stars and rods to scale, supports, selection, scale bar.

import { ramp, rampDomain } from "../view/colours.js";
import { QUANTITIES, fixed } from "../format.js";
import { isDark } from "../dom.js";
import { bounds, clamp, difference, distance, nice, sum } from "../geometry.js";
import { membersOf, pointsOf, targetsOf } from "../supports.js";
import { disc, draw, label, polyline, segments } from "./pen.js";

export const STRONG = 20; // weights from here on have the full colour
const LEAST_ALPHA = 0.1;
const MOST_ALPHA = 0.55;

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
  polyline(paint.context, paint.plan, paint.sheet.outline, { isClosed: true });
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
  draw(context, { colour: colour("ink"), width: 1.5 });
}

/** Lines every 10 mm (1, 2 or 5 mm where there is room), every tenth stronger. */
function drawGrid({ context, plan, sheet, colour }) {
  const step = nice(14 / plan.scale);
  const { low, high } = sheet.box;
  for (const axis of [0, 1]) {
    for (let k = Math.ceil(low[axis] / step); k * step <= high[axis]; k++) {
      const end = (corner) => plan.toScreen(corner.with(axis, k * step)).map((value) => Math.round(value) + 0.5);
      segments(context, [[end(low), end(high)]], { colour: colour(k % 5 === 0 ? "grid-strong" : "grid") });
    }
  }
}

/** Viridis without the end that vanishes on this paper. */
function sizeColour(share) {
  return ramp("viridis", isDark() ? 0.24 + 0.76 * share : 0.86 * share);
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
    if (sheet.isOutsideLaw(star)) hatch(paint, [x, y], 0.46 * sheet.spacing * plan.scale);
    segments(context, star.arms.map((arm) => arm.map((end) => plan.toScreen(end))), {
      colour: entry ? sizeColour((star.sizes[entry.column] - domain[0]) / (domain[1] - domain[0])) : ink,
      alpha: star.isReset ? 0.45 : 1,
      width: Math.max(1, star.sizes[2] * plan.scale),
    });
  }
}

/** Drawn rods to scale, piece by piece where their sections change. */
function drawRods(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const quantity = store.get("planColour");
  const key = sheet.rods.length && quantity in QUANTITIES && quantity !== "length" && QUANTITIES[quantity].key;
  const domain = key && rampDomain(sheet.values(quantity));
  context.lineCap = context.lineJoin = "round";
  for (const rod of sheet.rods) {
    const { points_mm: points, width_mm: width } = rod;
    const isEven = [rod[key] ?? width, width].every((values) => values.every((value) => value === values[0]));
    for (let from = 0; from < points.length - 1; from += isEven ? points.length : 1) {
      const shown = isEven ? points : points.slice(from, from + 2);
      const mean = (values) => (isEven ? values[0] : (values[from] + values[from + 1]) / 2);
      const value = key && mean(rod[key]);
      polyline(context, plan, shown, {
        colour: key ? sizeColour((value - domain[0]) / (domain[1] - domain[0])) : colour("ink"),
        width: Math.max(1, mean(width) * plan.scale),
      });
    }
  }
}

/** A small cross where a star was removed, a dot where its arms are too short to print. */
function drawVacant({ context, plan, colour }, star, x, y) {
  const reach = Math.max(2, Math.min(4, plan.scale));
  if (star.removed) {
    const corner = (a, b) => [x + a * reach, y + b * reach];
    segments(context, [[corner(-1, -1), corner(1, 1)], [corner(1, -1), corner(-1, 1)]], { colour: colour("ink-soft") });
  } else {
    disc(context, [x, y], 1.5, { fill: colour("ink-soft") });
  }
}

/** What the hatching means, where there is any. */
function drawHatchLegend(paint) {
  const { plan, sheet, store } = paint;
  if (!sheet.stars.some((star) => !star.isOffSheet && sheet.isOutsideLaw(star))) return;
  const [x, y] = [23, plan.canvas.clientHeight - (QUANTITIES[store.get("planColour")] ? 108 : 48)];
  hatch(paint, [x, y], 7);
  label(paint, "outside the calibrated range", [x + 14, y + 4], "left", "warn");
}

/** Hatching: a star's size is outside the range for which the law was calibrated. */
function hatch({ context, colour }, [x, y], radius) {
  context.save();
  disc(context, [x, y], radius);
  context.clip();
  const lines = [];
  for (let k = -radius; k <= radius; k += 5) lines.push([[x + k - radius, y + radius], [x + k + radius, y - radius]]);
  segments(context, lines, { colour: colour("warn"), alpha: 0.8 });
  context.restore();
}

/** Selection, hover and keyboard star, warnings' ring. */
function drawMarks(paint) {
  const { context, plan, sheet, store, colour } = paint;
  const radius = Math.max(6, 0.5 * sheet.spacing * plan.scale - 2);
  const accent = colour("accent");
  const ring = (star, width, dash) => disc(context, plan.toScreen(star.at), radius, { colour: accent, width, dash });
  const isQuiet = !["select", "brush"].includes(store.get("tool"));
  for (const key of store.get("selection")) {
    const star = sheet.byKey.get(key);
    if (!star) continue;
    disc(context, plan.toScreen(star.at), radius, { fill: accent, alpha: isQuiet ? 0.06 : 0.14 });
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
  disc(context, plan.toScreen(at), 10 + 22 * part, { colour: colour("warn"), width: 3, alpha: 1 - 0.8 * part });
}

function drawScaleBar(paint) {
  const { context, plan, colour } = paint;
  const length = nice(70 / plan.scale);
  const [x, y] = [16, plan.canvas.clientHeight - 16];
  const end = x + length * plan.scale;
  const pen = { colour: colour("muted"), width: 1.5 };
  segments(context, [[[x, y - 4], [x, y + 4]], [[x, y], [end, y]], [[end, y - 4], [end, y + 4]]], pen);
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

/** The area that the printer reaches and the frame of the fabric, centred on the sheet's box. */
function drawPrintArea(paint) {
  const { sheet, store } = paint;
  const { area_mm: area, frame_mm: frame, name } = sheet.printer;
  const title = store.get("document").printers?.find((one) => one.name === name)?.title ?? name;
  drawRoom(paint, frame, [6, 4], "Frame", isLarger(sheet.box.size, frame) && "the sheet is larger");
  drawRoom(paint, area, [2, 3], `${title} prints`, isLarger(plasticOf(sheet), area) && "the pattern reaches further");
}

const plasticOf = ({ stars, rods }) =>
  bounds([...stars.flatMap((star) => star.arms.flat()), ...rods.flatMap((rod) => rod.points_mm)]).size;

/** Why the chosen printer cannot print a sheet, in a few words; null if it can. */
export function tooLarge(sheet) {
  if (!sheet?.printer) return null;
  const { area_mm: area, frame_mm: frame } = sheet.printer;
  const said = (room) => `${fixed(room[0], 0)} × ${fixed(room[1], 0)} mm`;
  if (isLarger(sheet.box.size, frame)) return `The sheet is larger than the printer's frame, ${said(frame)}`;
  return isLarger(plasticOf(sheet), area) ? `The pattern is larger than the printer reaches, ${said(area)}` : null;
}

const isLarger = (size, room) => size[0] > room[0] || size[1] > room[1];

function drawRoom(paint, size, dash, title, fault) {
  const { context, plan, sheet, colour } = paint;
  const [cx, cy] = sheet.box.centre;
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => [cx + (a * size[0]) / 2, cy + (b * size[1]) / 2]);
  polyline(context, plan, corners, { isClosed: true, colour: colour(fault ? "bad" : "line-strong"), width: 1.5, dash });
  const [x, y] = plan.toScreen(corners[0]);
  const text = `${title} ${fixed(size[0], 0)} × ${fixed(size[1], 0)} mm${fault ? `: ${fault}` : ""}`;
  label(paint, text, [x + 4, y + 14], "left", fault ? "bad" : "muted");
}

/** Weights of places in a fit, as discs under the stars: the darker, the nearer the fit comes there. */
function drawWeights({ context, plan, sheet, colour }) {
  const weighed = sheet.stars.filter((star) => star.weight !== 1 && !star.isOffSheet);
  if (!weighed.length) return;
  const radius = 0.5 * sheet.spacing * plan.scale;
  context.save();
  polyline(context, plan, sheet.outline, { isClosed: true });
  context.clip();
  for (const star of weighed) {
    const share = clamp(Math.log(star.weight) / Math.log(STRONG), 0, 1);
    const strong = { fill: colour("weight"), alpha: LEAST_ALPHA + share * (MOST_ALPHA - LEAST_ALPHA) };
    const weak = { colour: colour("weight"), width: 1.5, dash: [2, 4] }; // such a place counts less
    disc(context, plan.toScreen(star.at), Math.max(2, radius - 1), star.weight < 1 ? weak : strong);
  }
  context.restore();
}

/** Needles and held edges, and where they take the sheet. */
function drawSupports(paint) {
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
      const pen = { fill: colour("needle"), colour: colour(isChosen ? "accent" : "paper"), width: 2 };
      disc(context, [x, y], isChosen ? 6.5 : 5, pen);
      if (isTool && place?.[2]) label(paint, `z ${fixed(place[2])}`, [x + 9, y - 7], "left", "needle");
    });
  });
}

/** Where a needle takes its point: a thin line and a cross. */
function drawTarget({ context, colour }, from, to, isChosen) {
  const pen = { colour: colour("needle"), alpha: isChosen ? 1 : 0.6 };
  segments(context, [[from, to]], { ...pen, dash: [3, 3] });
  const [x, y] = to;
  segments(context, [[[x - 4, y], [x + 4, y]], [[x, y - 4], [x, y + 4]]], { ...pen, width: 1.5 });
}

function drawHeldEdge(paint, a, b) {
  const { context, plan, colour } = paint;
  const [from, to] = [plan.toScreen(a), plan.toScreen(b)];
  const [length, [dx, dy]] = [distance(from, to), difference(to, from)];
  if (length < 1) return;
  const [ux, uy] = [dx / length, dy / length];
  segments(context, [[from, to]], { colour: colour("needle"), width: 2.5 });
  const barbs = [];
  for (let k = 4; k < length; k += 8) {
    const foot = [from[0] + k * ux, from[1] + k * uy];
    barbs.push([foot, sum(foot, [-5 * (uy + 0.7 * ux), 5 * (ux - 0.7 * uy)])]);
  }
  segments(context, barbs, { colour: colour("needle") });
}
