// Which point of the sheet a ray meets first.

/** The first triangle along a ray: {triangle, weights, along}, or null. */
export function pick({ start, direction }, positions, triangles) {
  let best = null;
  const [dx, dy, dz] = direction;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ax = positions[a],
      ay = positions[a + 1],
      az = positions[a + 2];
    const ux = positions[b] - ax,
      uy = positions[b + 1] - ay,
      uz = positions[b + 2] - az;
    const vx = positions[c] - ax,
      vy = positions[c + 1] - ay,
      vz = positions[c + 2] - az;
    const px = dy * vz - dz * vy,
      py = dz * vx - dx * vz,
      pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (Math.abs(determinant) < 1e-12) continue;
    const ox = start[0] - ax,
      oy = start[1] - ay,
      oz = start[2] - az;
    const u = (ox * px + oy * py + oz * pz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = oy * uz - oz * uy,
      qy = oz * ux - ox * uz,
      qz = ox * uy - oy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / determinant;
    if (v < 0 || u + v > 1) continue;
    const along = (vx * qx + vy * qy + vz * qz) / determinant;
    if (along > 0 && (!best || along < best.along)) best = { triangle: t / 3, weights: [1 - u - v, u, v], along };
  }
  return best;
}

/** The printed place [x, y] of what was met. */
export function printedPlace({ triangle, weights }, printed, triangles) {
  const place = [0, 0];
  weights.forEach((weight, k) => {
    const vertex = triangles[3 * triangle + k];
    place[0] += weight * printed[2 * vertex];
    place[1] += weight * printed[2 * vertex + 1];
  });
  return place;
}
