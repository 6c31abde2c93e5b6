// Solids of the picture: arms as bars with round ends, the rim of the fabric, needles with heads, the board.

const ACCENT = [60, 110, 235, 255];
const CAP = 3; // stations of a round end
const EMBEDDED_MM = 0.4; // of a bar in the fabric, so that no gap is seen under it
const NEEDLE_MM = [0.3, 1.1]; // radii of shaft and head
const TUBE_MM = 0.9; // radius of the tube along a held curve
const HEAD_ABOVE_MM = 3.4; // of the middle of a head over the held point
const BOARD_MM = 4;
const BOARD_CELLS = 32;
const SIDES = 12;

/** Thickness of the fabric as it is drawn. */
export const FABRIC_MM = 0.8;
/** From a held point to the middle of its needle's head. */
export const headOf = ([x, y, z]) => [x, y, z + HEAD_ABOVE_MM];

/** Bars. `arms`: (A, K, 3, 3) left and right upper edge and the middle on the fabric; `normals`: (A, K, 3). */
export function bars(arms, normals, count) {
  const rows = arms.length / (9 * count);
  const stations = rows + 2 * CAP;
  const positions = new Float32Array(count * stations * 18);
  const directions = new Float32Array(count * stations * 18);
  const [a, l, n] = [new Float64Array(3), new Float64Array(3), new Float64Array(3)];
  let at = 0;
  for (let arm = 0; arm < count; arm++) {
    for (let s = 0; s < stations; s++) {
      const row = Math.min(Math.max(s - CAP, 0), rows - 1);
      const step = s < CAP ? s - CAP : Math.max(s - CAP - rows + 1, 0);
      const turn = (step * Math.PI) / (2 * CAP);
      const from = 9 * (arm * rows + row);
      for (let c = 0; c < 3; c++) {
        a[c] = (arms[from + c] - arms[from + 3 + c]) / 2;
        n[c] = normals[from / 3 + c];
      }
      const half = Math.hypot(...a) || 1e-9;
      for (let c = 0; c < 3; c++) l[c] = (a[(c + 1) % 3] * n[(c + 2) % 3] - a[(c + 2) % 3] * n[(c + 1) % 3]) / half;
      for (const [side, part] of [[1, 0], [-1, 0], [1, 1], [1, 2], [-1, 1], [-1, 2]]) {
        for (let c = 0; c < 3; c++) {
          const middle = (arms[from + c] + arms[from + 3 + c]) / 2;
          const out = (side * Math.cos(turn) * a[c]) / half + Math.sin(turn) * l[c];
          const base = part === 2 ? arms[from + 6 + c] - middle - EMBEDDED_MM * n[c] : 0;
          positions[at] = middle + half * out + base;
          directions[at++] = part ? out : n[c];
        }
      }
    }
  }
  if (joined.count !== count || joined.stations !== stations) {
    const [triangles, few] = [1, 2].map((step) => strips(count, stations, step));
    joined = { count, stations, triangles, few };
  }
  const { triangles, few } = joined;
  return { positions, normals: directions, triangles, few, perArm: 6 * stations };
}

let joined = {}; // triangles of the last bars: those of the next shape are the same

/** Triangles of bars between every station, or every second one. */
function strips(count, stations, step) {
  const pieces = Math.floor(stations / step) - 1;
  const triangles = new Uint32Array(18 * count * pieces);
  for (let piece = 0, index = 0; piece < count * pieces; piece++) {
    const first = 6 * (stations * Math.floor(piece / pieces) + step * ((piece % pieces) + 1) - 1);
    for (const side of [[0, 1], [3, 2], [4, 5]]) {
      const [i, j] = side.map((corner) => first + corner);
      triangles.set([i, j, i + 6 * step, j, j + 6 * step, i + 6 * step], index);
      index += 6;
    }
  }
  return triangles;
}

/** Colours of the bars' points: the accent where the arm's star is marked, transparent elsewhere. */
export function barColours(armSites, perArm, isMarked) {
  const colours = new Uint8Array(4 * armSites.length * perArm);
  const one = new Uint8Array(4 * perArm).map((_, k) => ACCENT[k % 4]);
  armSites.forEach((site, arm) => isMarked(site) && colours.set(one, 4 * perArm * arm));
  return colours;
}

/** The strip around the fabric: `outline` has the edges (E, 2) of its border, the sheet to their left. */
export function rim(positions, normals, outline) {
  const count = outline.length / 2;
  const made = { positions: new Float32Array(12 * count), normals: new Float32Array(12 * count) };
  for (let e = 0; e < count; e++) {
    const [i, j] = [3 * outline[2 * e], 3 * outline[2 * e + 1]];
    for (let c = 0; c < 3; c++) {
      const [d, f] = [(c + 1) % 3, (c + 2) % 3];
      const out =
        (positions[j + d] - positions[i + d]) * normals[i + f] - (positions[j + f] - positions[i + f]) * normals[i + d];
      [i, i, j, j].forEach((k, corner) => {
        made.positions[12 * e + 3 * corner + c] = positions[k + c] - (corner % 2) * FABRIC_MM * normals[k + c];
        made.normals[12 * e + 3 * corner + c] = out;
      });
    }
  }
  const triangles = Uint32Array.from({ length: 6 * count }, (_, k) => 4 * Math.floor(k / 6) + [0, 1, 2, 1, 3, 2][k % 6]);
  return { ...made, triangles };
}

/** Needles (N, 2, 3), foot and tip, and the ends of pieces of tubes along held curves, which do not stand upright. */
export function parted(needles) {
  const [upright, pieces] = [[], []];
  for (let k = 0; k < needles.length; k += 6) {
    const [foot, tip] = [needles.subarray(k, k + 3), needles.subarray(k + 3, k + 6)];
    (foot[0] === tip[0] && foot[1] === tip[1] ? upright : pieces).push([foot, tip]);
  }
  return { upright, pieces };
}

/** All needles, from the board to their heads, and tubes. */
export function needleSolids({ upright, pieces }, level) {
  const made = { positions: [], normals: [], triangles: [] };
  const ball = Array.from({ length: 9 }, (_, row) => [Math.sin((row * Math.PI) / 8), -Math.cos((row * Math.PI) / 8)]);
  for (const [, tip] of upright) {
    const [x, y, z] = headOf(tip);
    turned(made, [x, y, 0], [0, 0, 1], [[NEEDLE_MM[0], level, 1, 0], [NEEDLE_MM[0], z, 1, 0]]);
    turned(made, [x, y, z], [0, 0, 1], ball.map(([r, h]) => [NEEDLE_MM[1] * r, NEEDLE_MM[1] * h, r, h]));
  }
  for (const [from, to] of pieces) {
    const along = to.map((value, c) => value - from[c]);
    const length = Math.hypot(...along) || 1e-9;
    const end = (rows, at) => ball.slice(...rows).map(([r, h]) => [TUBE_MM * r, at + TUBE_MM * h, r, h]);
    turned(made, from, along.map((value) => value / length), [...end([0, 5], 0), ...end([4], length)]);
  }
  return arrays(made);
}

/** A profile [radius, height, outward, upward] turned about an axis from a place on. */
function turned({ positions, normals, triangles }, from, [a, b, c], profile) {
  const flat = Math.hypot(a, b);
  const u = flat ? [-b / flat, a / flat, 0] : [1, 0, 0];
  const axis = [a, b, c];
  const v = [0, 1, 2].map((k) => axis[(k + 1) % 3] * u[(k + 2) % 3] - axis[(k + 2) % 3] * u[(k + 1) % 3]);
  profile.forEach(([radius, height, out, up], row) => {
    for (let k = 0; k <= SIDES; k++) {
      const [cos, sin] = [Math.cos((2 * Math.PI * k) / SIDES), Math.sin((2 * Math.PI * k) / SIDES)];
      const here = positions.length / 3;
      for (let i = 0; i < 3; i++) {
        const outward = cos * u[i] + sin * v[i];
        positions.push(from[i] + radius * outward + height * axis[i]);
        normals.push(out * outward + up * axis[i]);
      }
      if (row && k) triangles.push(here - 1, here, here - SIDES - 1, here - 1, here - SIDES - 1, here - SIDES - 2);
    }
  });
}

/** The board under a box {low, high}: drilling marks at the needles, ticks of 10 mm along its edges. */
export function board({ low, high }, { upright }, level) {
  const made = { positions: [], normals: [], triangles: [], lines: [] };
  const margin = Math.max(6, 0.05 * Math.hypot(high[0] - low[0], high[1] - low[1]));
  const ends = [low.map((value) => value - margin), high.map((value) => value + margin)];
  // faces as grids, whose points hold the light of the sky
  for (const [axis, end] of [[2, 1], [0, 0], [0, 1], [1, 0], [1, 1]]) {
    const [u, v] = [0, 1, 2].filter((c) => c !== axis);
    const cells = axis === 2 ? BOARD_CELLS : 1;
    for (let row = 0; row <= cells; row++) {
      for (let column = 0; column <= cells; column++) {
        const at = [end, end, end];
        [at[u], at[v]] = [row / cells, column / cells];
        const here = made.positions.length / 3;
        made.positions.push(...[0, 1].map((c) => ends[0][c] + at[c] * (ends[1][c] - ends[0][c])));
        made.positions.push(level - BOARD_MM * (1 - at[2]));
        made.normals.push(...[0, 1, 2].map((c) => (c === axis ? 2 * end - 1 : 0)));
        if (row && column)
          made.triangles.push(here, here - 1, here - cells - 2, here, here - cells - 2, here - cells - 1);
      }
    }
  }
  const stroke = (...places) => {
    const first = made.positions.length / 3;
    for (const [x, y] of places) {
      made.positions.push(x, y, level + 0.02);
      made.normals.push(0, 0, 1);
    }
    for (let k = 1; k < places.length; k++) made.lines.push(first + k - 1, first + k);
  };
  const [[left, front], [right, back]] = ends;
  const tick = (value) => (value % 50 ? 1.5 : 4);
  for (let x = 10 * Math.ceil(left / 10); x < right; x += 10) {
    stroke([x, front], [x, front + tick(x)]);
    stroke([x, back], [x, back - tick(x)]);
  }
  for (let y = 10 * Math.ceil(front / 10); y < back; y += 10) {
    stroke([left, y], [left + tick(y), y]);
    stroke([right, y], [right - tick(y), y]);
  }
  for (const [[x, y]] of upright) {
    stroke([x - 2.5, y], [x + 2.5, y]);
    stroke([x, y - 2.5], [x, y + 2.5]);
    const turns = Array.from({ length: 17 }, (_, turn) => (turn * Math.PI) / 8);
    stroke(...turns.map((turn) => [x + 1.5 * Math.cos(turn), y + 1.5 * Math.sin(turn)]));
  }
  const corners = [left, front, level, right, front, level, left, back, level, right, back, level];
  return { ...arrays(made), corners };
}

const arrays = ({ positions, normals, triangles, lines = [] }) => ({
  positions: new Float32Array(positions),
  normals: new Float32Array(normals),
  triangles: new Uint32Array(triangles),
  lines: new Uint32Array(lines),
});
