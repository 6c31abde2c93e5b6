// Colour scales that people with any colour vision can read: viridis for sizes, blue to orange for signed values.

const VIRIDIS = [
  [68, 1, 84],
  [71, 44, 122],
  [59, 81, 139],
  [44, 113, 142],
  [33, 144, 141],
  [39, 173, 129],
  [92, 200, 99],
  [170, 220, 50],
  [253, 231, 37],
];
const DIVERGING = [
  [22, 74, 140],
  [67, 130, 190],
  [150, 190, 222],
  [240, 238, 232],
  [240, 180, 120],
  [205, 110, 40],
  [130, 55, 10],
];
const SCALES = { viridis: VIRIDIS, diverging: DIVERGING };

export function ramp(name, share) {
  const [r, g, b] = rgb(name, share);
  return `rgb(${r | 0} ${g | 0} ${b | 0})`;
}

/** Colour of a share from 0 to 1, three numbers to 255. */
export function rgb(name, share) {
  const stops = SCALES[name];
  const at = Math.min(Math.max(Number.isFinite(share) ? share : 0, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((low, c) => low + (at - k) * (stops[k + 1][c] - low));
}

export function rampDomain(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(low <= high)) return [0, 1];
  return high - low < 1e-9 ? [low - 0.5, high + 0.5] : [low, high];
}

/** The quantities the view can show as colours. */
export const FIELDS = {
  none: { name: "Plain" },
  height: { name: "Height", unit: "mm", digits: 1, scale: "viridis" },
  curvature: { name: "Curvature", title: "Mean curvature", unit: "1/m", scale: "diverging", factor: 1000 },
  strain: { name: "Strain", title: "Area strain", unit: "%", scale: "diverging", factor: 100 },
  distance: { name: "Exact to preview", title: "Exact shape to preview", unit: "mm", scale: "viridis", isDistance: true },
  target: { name: "To the target", title: "Distance to the target", unit: "mm", scale: "viridis", isDistance: true },
};

const ROUND_STEPS = [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];

/** Smallest round number of at least `value` that four equal steps with few digits divide. */
function roundedUp(value) {
  const power = 10 ** Math.floor(Math.log10(value / 4));
  return 4 * power * ROUND_STEPS.find((step) => step * power >= (value / 4) * (1 - 1e-9));
}

/** Digits after the point of a step between the numbers of a legend. */
export function digitsOf(step) {
  let digits = 0;
  while (digits < 6 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6 * step * 10 ** digits)
    digits++;
  return digits;
}

/** Range of a field: robust (2 to 98 %) for curvature and strain, symmetric about 0 for signed scales; ends are round. */
export function fieldDomain(name, values) {
  const { scale } = FIELDS[name];
  if (name === "height") return rampDomain(values);
  const sorted = Float32Array.from(values).sort();
  const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
  if (scale === "diverging") {
    const most = Math.max(Math.abs(at(0.02)), Math.abs(at(0.98)), 1e-6);
    return [-roundedUp(2 * most) / 2, roundedUp(2 * most) / 2];
  }
  return [0, roundedUp(Math.max(at(0.995), 1e-6))];
}

/** Colours of all vertices, four bytes each. */
export function vertexColours(name, values, domain) {
  const colours = new Uint8Array(4 * values.length);
  const { scale } = FIELDS[name];
  const span = domain[1] - domain[0];
  for (let k = 0; k < values.length; k++) {
    const [r, g, b] = rgb(scale, (values[k] - domain[0]) / span);
    colours.set([r, g, b, 255], 4 * k);
  }
  return colours;
}
