// The printable area of the chosen printer and the frame of the fabric, around the sheet.

import { fixed } from "../format.js";
import { bounds } from "../geometry.js";
import { label } from "./draw.js";
import { polyline, stroke } from "./tools/common.js";

/** The area that the printer reaches and the frame of the fabric, centred on the sheet's box. */
export function drawPrintArea(paint) {
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
  polyline(context, plan, corners, true);
  stroke(context, { colour: colour(fault ? "bad" : "line-strong"), width: 1.5, dash });
  const [x, y] = plan.toScreen(corners[0]);
  const text = `${title} ${fixed(size[0], 0)} × ${fixed(size[1], 0)} mm${fault ? `: ${fault}` : ""}`;
  label(paint, text, [x + 4, y + 14], "left", fault ? "bad" : "muted");
}
