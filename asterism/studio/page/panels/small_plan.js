// Small pictures of plane lines: drawings, and earlier states of a design.

import { bounds } from "../geometry.js";

/** A pen on a canvas that shows some points as large as they fit: {context, scale, at, path}. `ratio`: pixels of the
 * canvas for each of the picture. */
export function smallPlan(canvas, points, margin, ratio = 1) {
  const context = canvas.getContext("2d");
  const [width, height] = [canvas.width / ratio, canvas.height / ratio];
  const { size, centre } = bounds(points);
  const room = [width - 2 * margin, height - 2 * margin];
  const scale = Math.min(...room.map((side, axis) => side / Math.max(size[axis], 1e-9)));
  const at = ([x, y]) => [width / 2 + scale * (x - centre[0]), height / 2 - scale * (y - centre[1])];
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  /** The path along some points. */
  function path(line) {
    context.beginPath();
    line.forEach((point) => context.lineTo(...at(point)));
  }
  return { context, scale, at, path };
}
