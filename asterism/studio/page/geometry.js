// Plane geometry in printed millimetres. Points are [x, y].

export const sum = (a, b) => [a[0] + b[0], a[1] + b[1]];
export const difference = (a, b) => [a[0] - b[0], a[1] - b[1]];
export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
export const between = (a, b, share) => [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1];
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

const ARC_STEP_RAD = 0.04; // half of the angle of a piece of an arc

/** Weight of a brush at a share of its radius, 1 in the middle. */
export const falloff = (share) => (1 - share ** 2) ** 2;

export function bounds(points) {
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (const point of points) {
    for (const k of [0, 1]) {
      low[k] = Math.min(low[k], point[k]);
      high[k] = Math.max(high[k], point[k]);
    }
  }
  return { low, high, size: difference(high, low), centre: between(low, high, 0.5) };
}

/** Whether a point is inside a polygon, by the even-odd rule. */
export function isInside(point, polygon) {
  let inside = false;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [a, b] = [polygon[i], polygon[j]];
    if (a[1] > point[1] !== b[1] > point[1]) {
      if (point[0] < ((b[0] - a[0]) * (point[1] - a[1])) / (b[1] - a[1]) + a[0]) inside = !inside;
    }
  }
  return inside;
}

/** The edges of a polygon, [from, to] each; edge i runs from corner i to the next. */
export const edgesOf = (polygon) => polygon.map((corner, k) => [corner, polygon[(k + 1) % polygon.length]]);

/** The nearest point of a segment: {point, distance, share}. */
export function nearestOnSegment(point, a, b) {
  const along = difference(b, a);
  const length2 = dot(along, along);
  const share = length2 ? clamp(dot(difference(point, a), along) / length2, 0, 1) : 0;
  const nearest = between(a, b, share);
  return { point: nearest, distance: distance(point, nearest), share };
}

/** The nearest edge of a polygon: {edge, point, distance, share}. */
export function nearestEdge(point, polygon) {
  const edges = edgesOf(polygon).map(([a, b], edge) => ({ edge, ...nearestOnSegment(point, a, b) }));
  return edges.reduce((best, one) => (one.distance < best.distance ? one : best));
}

/** The first with the least `away`, if that is less than a reach; else null. */
export const nearest = (all, reach) =>
  all.reduce((best, one) => (one.away < (best?.away ?? reach) ? one : best), null);

/** Share of the way along a ray (direction of length 1) at which it leaves a polygon; Infinity if it does not. */
export function rayLength(start, direction, polygon) {
  let least = Infinity;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const edge = difference(polygon[i], polygon[j]);
    const off = difference(polygon[j], start);
    const cross = direction[0] * edge[1] - direction[1] * edge[0];
    if (Math.abs(cross) < 1e-12) continue;
    const along = (off[0] * edge[1] - off[1] * edge[0]) / cross;
    const across = (off[0] * direction[1] - off[1] * direction[0]) / cross;
    if (along > 1e-9 && across >= 0 && across <= 1) least = Math.min(least, along);
  }
  return least;
}

export function centroid(polygon) {
  let [x, y, twice] = [0, 0, 0]; // moments, and the area
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const cross = polygon[j][0] * polygon[i][1] - polygon[i][0] * polygon[j][1];
    x += (polygon[j][0] + polygon[i][0]) * cross;
    y += (polygon[j][1] + polygon[i][1]) * cross;
    twice += cross;
  }
  return Math.abs(twice) < 2e-9 ? bounds(polygon).centre : [x / (3 * twice), y / (3 * twice)];
}

/** Whether two edges of a polygon cross that are not neighbours: the server refuses such an outline. */
export function crossesItself(polygon) {
  const count = polygon.length;
  const side = (a, b, c) => Math.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  for (let i = 0; i < count; i++) {
    for (let j = i + 2; j < count; j++) {
      if (i === 0 && j === count - 1) continue;
      const [a, b] = [polygon[i], polygon[(i + 1) % count]];
      const [c, d] = [polygon[j], polygon[(j + 1) % count]];
      if (side(a, b, c) !== side(a, b, d) && side(c, d, a) !== side(c, d, b)) return true;
    }
  }
  return false;
}

/** Unit vector of a direction in degrees. */
export const direction = (degrees) => [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];

/** Corners on an ellipse, at equal steps of its angle from `start` on; `turn`: of its axes, in degrees. */
export function ellipse(centre, [a, b], { count = 72, start = 0, turn = 0 } = {}) {
  const [c, s] = direction(turn);
  return Array.from({ length: count }, (_, k) => {
    const angle = start + (2 * Math.PI * k) / count;
    const [x, y] = [a * Math.cos(angle), b * Math.sin(angle)];
    return roundPoint([centre[0] + c * x - s * y, centre[1] + s * x + c * y]);
  });
}

export const isClockwise = (corners) =>
  corners.reduce((twice, [x, y], k) => twice + corners.at(k - 1)[0] * y - corners.at(k - 1)[1] * x, 0) < 0;

/** An edge of a counterclockwise polygon: its middle, half its length, its direction, and the direction out of it. */
export function edgeOf(corners, k) {
  const [a, b] = [corners[k], corners[(k + 1) % corners.length]];
  const half = distance(a, b) / 2;
  const along = difference(b, a).map((value) => value / (2 * half || 1));
  return { middle: between(a, b, 0.5), half, along, out: [along[1], -along[0]] };
}

/** Points of the arcs over the edges of a counterclockwise polygon, edge by edge without its end; their middles stand out by the bulges. */
export function arcs(corners, bulges) {
  return corners.map((corner, k) => {
    if (!bulges[k]) return [corner];
    const { middle, half, along, out } = edgeOf(corners, k);
    const end = 2 * Math.atan(bulges[k] / half); // half of the angle of the arc
    const radius = half / Math.sin(end);
    const count = Math.max(2, Math.ceil(Math.abs(end) / ARC_STEP_RAD));
    const points = Array.from({ length: count }, (_, step) => {
      const angle = end * ((2 * step) / count - 1);
      const [x, y] = [radius * Math.sin(angle), radius * (Math.cos(angle) - Math.cos(end))];
      return [0, 1].map((axis) => middle[axis] + x * along[axis] + y * out[axis]);
    });
    return points.with(0, corner);
  });
}

/**
 * Points of the smooth closed curve that the server has through points, from each of these to before the next: a cubic
 * spline over the square roots of their distances.
 */
export function smooth(points) {
  const [count, after] = [points.length, (k) => (k + 1) % points.length];
  const width = points.map((point, k) => Math.sqrt(distance(point, points[after(k)]) || 1e-9));
  const slope = points.map((point, k) => difference(points[after(k)], point).map((value) => value / width[k]));
  const bend = points.map(() => [0, 0]); // second derivatives; each equation has twice the weight at its own
  for (let sweep = 0; sweep < 30; sweep++) {
    points.forEach((_, k) => {
      const before = (k + count - 1) % count;
      bend[k] = bend[k].map((_, axis) => {
        const beside = width[before] * bend[before][axis] + width[k] * bend[after(k)][axis];
        return (6 * (slope[k][axis] - slope[before][axis]) - beside) / (2 * (width[before] + width[k]));
      });
    });
  }
  const steps = clamp(Math.ceil(1000 / count), 4, 16);
  return points.map((point, k) =>
    Array.from({ length: steps }, (_, step) => {
      const [t, u, next] = [step / steps, 1 - step / steps, after(k)];
      const droop = (axis) => (u - u ** 3) * bend[k][axis] + (t - t ** 3) * bend[next][axis];
      return [0, 1].map((axis) => u * point[axis] + t * points[next][axis] - (width[k] ** 2 / 6) * droop(axis));
    }),
  );
}

export const round = (value, digits = 3) => Number(value.toFixed(digits));
export const roundPoint = (point, digits = 3) => point.map((value) => round(value, digits));

/** Where mirrors and sixfold turns about the origin take a point, itself first, without repetitions. */
export function images(point, { mirrorX, mirrorY, sixfold }) {
  let all = [point];
  if (mirrorX) all = all.flatMap(([x, y]) => [[x, y], [-x, y]]);
  if (mirrorY) all = all.flatMap(([x, y]) => [[x, y], [x, -y]]);
  if (sixfold) {
    const turns = [0, 60, 120, 180, 240, 300].map(direction);
    all = all.flatMap(([x, y]) => turns.map(([c, s]) => [c * x - s * y, s * x + c * y]));
  }
  return all.filter((place, k) => all.findIndex((other) => distance(place, other) < 1e-6) === k);
}

/** A pleasant number of about this size: 1, 2 or 5 times a power of ten. */
export function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}
