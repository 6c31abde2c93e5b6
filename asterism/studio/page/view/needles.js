// Needles as thin prisms from the ground to a head just above the sheet.

const SIDES = 8;
const ABOVE_MM = 4; // of the head over the held point

/** Positions, normals and triangles of all needles. `needles`: (N, 2, 3) foot and tip. */
export function needleSurface(needles, size) {
  const count = needles.length / 6;
  const [radius, head] = [0.0035 * size, 0.0095 * size];
  const parts = [];
  for (let k = 0; k < count; k++) {
    const foot = needles.subarray(6 * k, 6 * k + 3);
    const tip = needles.subarray(6 * k + 3, 6 * k + 6);
    const top = tip[2] + ABOVE_MM;
    parts.push(...prism(tip[0], tip[1], Math.min(foot[2], tip[2]), top, radius));
    parts.push(...ball(tip[0], tip[1], top + 0.6 * head, head));
  }
  return joined(parts);
}

function prism(x, y, low, high, radius) {
  const positions = [];
  const normals = [];
  const triangles = [];
  for (let k = 0; k <= SIDES; k++) {
    const [c, s] = [Math.cos((2 * Math.PI * k) / SIDES), Math.sin((2 * Math.PI * k) / SIDES)];
    for (const z of [low, high]) {
      positions.push(x + radius * c, y + radius * s, z);
      normals.push(c, s, 0);
    }
    if (k < SIDES) triangles.push(2 * k, 2 * k + 2, 2 * k + 3, 2 * k, 2 * k + 3, 2 * k + 1);
  }
  return [{ positions, normals, triangles }];
}

function ball(x, y, z, radius) {
  const positions = [];
  const normals = [];
  const triangles = [];
  const rows = 6;
  for (let row = 0; row <= rows; row++) {
    const up = -Math.PI / 2 + (Math.PI * row) / rows;
    for (let k = 0; k <= SIDES; k++) {
      const around = (2 * Math.PI * k) / SIDES;
      const n = [Math.cos(up) * Math.cos(around), Math.cos(up) * Math.sin(around), Math.sin(up)];
      positions.push(x + radius * n[0], y + radius * n[1], z + radius * n[2]);
      normals.push(...n);
      if (row < rows && k < SIDES) {
        const a = row * (SIDES + 1) + k;
        const b = a + SIDES + 1;
        triangles.push(a, a + 1, b + 1, a, b + 1, b);
      }
    }
  }
  return [{ positions, normals, triangles }];
}

function joined(parts) {
  const positions = [];
  const normals = [];
  const triangles = [];
  for (const part of parts) {
    const first = positions.length / 3;
    positions.push(...part.positions);
    normals.push(...part.normals);
    triangles.push(...part.triangles.map((index) => index + first));
  }
  return {
    positions: new Float32Array(positions),
    normals: new Float32Array(normals),
    triangles: new Uint32Array(triangles),
  };
}
