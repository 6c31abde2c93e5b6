// The sheet's triangles: normals of the vertices, fields to colour by.

/** Unit normals of the vertices, from the areas of the triangles around; on the plastic side. */
export function vertexNormals(positions, triangles) {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    for (let k = 0; k < 3; k++) {
      const i = (k + 1) % 3;
      const j = (k + 2) % 3;
      const along = (positions[b + i] - positions[a + i]) * (positions[c + j] - positions[a + j]);
      const normal = along - (positions[b + j] - positions[a + j]) * (positions[c + i] - positions[a + i]);
      normals[a + k] += normal;
      normals[b + k] += normal;
      normals[c + k] += normal;
    }
  }
  for (let k = 0; k < normals.length; k += 3) {
    const length = Math.hypot(normals[k], normals[k + 1], normals[k + 2]) || 1;
    for (let c = 0; c < 3; c++) normals[k + c] /= length;
  }
  return normals;
}

/** Values of a field at the vertices, in the unit that its legend shows; null if this shape has none. */
export function fieldValues(name, shape) {
  if (name === "height") {
    const heights = new Float32Array(shape.positions.length / 3);
    let low = Infinity;
    for (let k = 0; k < heights.length; k++) low = Math.min(low, shape.positions[3 * k + 2]);
    for (let k = 0; k < heights.length; k++) heights[k] = shape.positions[3 * k + 2] - low;
    return heights;
  }
  if (name === "distance") return shape.before ? distances(shape.exact, shape.before) : null;
  const factor = { curvature: 1000, strain: 100, target: 1 }[name];
  const values = shape[name];
  return factor && values ? values.map((value) => factor * value) : null;
}

/** Distances of the same places of two sheets. */
function distances(one, other) {
  return Float32Array.from({ length: one.length / 3 }, (_, k) =>
    Math.hypot(...[0, 1, 2].map((c) => one[3 * k + c] - other[3 * k + c])),
  );
}

/** Both ends of each piece of the lines on which values at the vertices are multiples of a step. */
export function contours(positions, triangles, values, step) {
  const ends = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [triangles[t], triangles[t + 1], triangles[t + 2]].sort((a, b) => values[a] - values[b]);
    const [low, middle, high] = corners.map((corner) => values[corner] / step);
    for (let level = Math.floor(low) + 1; level <= high; level++) {
      const [a, b, c] = corners;
      const crossed = level < middle ? [[a, b, low, middle], [a, c, low, high]] : [[b, c, middle, high], [a, c, low, high]];
      for (const [from, to, start, end] of crossed) {
        const share = end > start ? (level - start) / (end - start) : 0;
        for (let k = 0; k < 3; k++) ends.push((1 - share) * positions[3 * from + k] + share * positions[3 * to + k]);
      }
    }
  }
  return new Float32Array(ends);
}

/** Lowest and highest corner of a set of positions. */
export function box(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < positions.length; k++) {
    const c = k % 3;
    if (positions[k] < low[c]) low[c] = positions[k];
    if (positions[k] > high[c]) high[c] = positions[k];
  }
  return { low, high };
}
