// Rods while the brush paints them, until the server answers with its own.

import { painted } from "./brush_modes.js";
import { between, clamp, distance, falloff } from "./geometry.js";

const STEP_MM = 1; // of the places along a rod whose sizes the server takes from its field, too
const MEAN_SHARE = 0.5; // a smoothing brush looks so far around a place, in its radius

/** The rods after the brush {size, mode, radius, strength, value, low, high} was put down at the images of one place. Those of the names `kept` keep their sizes. */
export function brushed(rods, brush, images, kept) {
  const pieces = rods.map(inSteps);
  const { size, mode, radius, strength, value, low, high } = brush;
  const near = [];
  for (const rod of pieces) {
    if (kept.has(rod.name)) continue;
    rod.points_mm.forEach((at, k) => {
      const away = Math.min(...images.map((place) => distance(place, at)));
      if (away < radius) near.push({ rod, k, at, old: rod[size][k], share: strength * falloff(away / radius) });
    });
  }
  for (const { rod, k, at, old, share } of near) {
    const around = () => mean(near, at, MEAN_SHARE * radius);
    rod[size][k] = clamp(painted(mode, old, share, value, around), low, high);
  }
  return pieces;
}

/** A copy of a rod with a place at least every millimetre. */
function inSteps(rod) {
  const { name, points_mm: points, ...sizes } = rod;
  const firsts = Object.entries(sizes).map(([key, values]) => [key, [values[0]]]);
  const out = { name, points_mm: [points[0]], ...Object.fromEntries(firsts) };
  for (let k = 1; k < points.length; k++) {
    const count = Math.max(1, Math.ceil(distance(points[k - 1], points[k]) / STEP_MM));
    for (let step = 1; step <= count; step++) {
      out.points_mm.push(between(points[k - 1], points[k], step / count));
      for (const [key, values] of Object.entries(sizes)) {
        out[key].push(values[k - 1] + (step / count) * (values[k] - values[k - 1]));
      }
    }
  }
  return out;
}

function mean(near, at, reach) {
  const around = near.filter((other) => distance(other.at, at) <= reach);
  return around.reduce((total, { old }) => total + old, 0) / around.length;
}
