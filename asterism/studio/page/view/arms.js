// The arms as ribbons on the plastic side: from the engine's stations, left and right edge.

const ACCENT = [60, 110, 235, 255];

/** Positions, normals and triangles of all ribbons. `arms`: (A, K, 2, 3); `normals`: (A, K, 3). */
export function ribbons(arms, normals, count) {
  const stations = arms.length / (6 * count);
  const wide = new Float32Array(arms.length);
  for (let k = 0; k < arms.length / 6; k++) {
    for (const side of [0, 3]) wide.set(normals.subarray(3 * k, 3 * k + 3), 6 * k + side);
  }
  const triangles = new Uint32Array(count * (stations - 1) * 6);
  let at = 0;
  for (let arm = 0; arm < count; arm++) {
    for (let k = 0; k < stations - 1; k++) {
      const first = 2 * (arm * stations + k);
      triangles.set([first, first + 1, first + 3, first, first + 3, first + 2], at);
      at += 6;
    }
  }
  return { positions: arms, normals: wide, triangles, stations };
}

/** Colours of the ribbons' points: the accent where the arm's star is marked, transparent elsewhere. */
export function armColours(armSites, stations, isMarked) {
  const colours = new Uint8Array(armSites.length * stations * 8);
  armSites.forEach((site, arm) => {
    if (!isMarked(site)) return;
    for (let k = 0; k < 2 * stations; k++) colours.set(ACCENT, 4 * (2 * stations * arm + k));
  });
  return colours;
}
