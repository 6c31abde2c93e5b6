// Discs, lines and texts of the plan. A pen {colour, width, dash, alpha, fill} draws along a path, and fills it before; a
// path without a pen stays in the context.

/** A disc on the screen. */
export function disc(context, [x, y], radius, pen = null) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  draw(context, pen);
}

export const circle = (context, plan, centre, radiusMm, pen = null) =>
  disc(context, plan.toScreen(centre), Math.max(1, radiusMm * plan.scale), pen);

/** Pieces of lines on the screen, [from, to] each. */
export function segments(context, pieces, pen = null) {
  context.beginPath();
  for (const [from, to] of pieces) {
    context.moveTo(...from);
    context.lineTo(...to);
  }
  draw(context, pen);
}

/** A line along places of the sheet; a pen may close it. */
export function polyline(context, plan, points, pen = null) {
  context.beginPath();
  points.forEach((point, k) => context[k ? "lineTo" : "moveTo"](...plan.toScreen(point)));
  if (pen?.isClosed) context.closePath();
  draw(context, pen);
}

/** Draws along the path of a context. */
export function draw(context, pen) {
  if (!pen) return;
  const { colour, width = 1, dash = [], alpha = 1, fill } = pen;
  context.globalAlpha = alpha;
  if (fill) {
    context.fillStyle = fill;
    context.fill();
  }
  if (colour) {
    Object.assign(context, { strokeStyle: colour, lineWidth: width });
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
  }
  context.globalAlpha = 1;
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
