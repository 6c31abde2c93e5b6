// An orbiting camera: a target, a distance, and two angles. It stays where it is when the shape changes but little.

import { clamp } from "../geometry.js";

const SLOPE = Math.tan((13 * Math.PI) / 180); // half of the picture's height over the distance
const BORDER = 1.12; // of a picture that shows all, over what is shown
const MAX_PITCH = Math.PI / 2;

/** Named views: turn about z and height above the horizon, degrees. */
export const VIEWS = {
  perspective: { name: "Perspective", turn: -62, pitch: 28 },
  top: { name: "Top", turn: -90, pitch: 90 },
  bottom: { name: "Bottom", turn: -90, pitch: -90 },
  front: { name: "Front", turn: -90, pitch: 0 },
  back: { name: "Back", turn: 90, pitch: 0 },
  left: { name: "Left", turn: 180, pitch: 0 },
  right: { name: "Right", turn: 0, pitch: 0 },
};

export class Camera {
  target = [0, 0, 0];
  distance = 300;
  isOrthographic = false;
  isOwn = false; // turned, moved or zoomed by hand since it was last asked to show all

  constructor() {
    this.look("perspective");
  }

  /** Directions of the camera in space: to the right, upwards, and towards the eye. */
  get axes() {
    const [ct, st, cp, sp] = [Math.cos(this.turn), Math.sin(this.turn), Math.cos(this.pitch), Math.sin(this.pitch)];
    const towards = [cp * ct, cp * st, sp];
    const right = [-st, ct, 0];
    const up = [-sp * ct, -sp * st, cp];
    return { right, up, towards };
  }

  get eye() {
    const { towards } = this.axes;
    return this.target.map((value, k) => value + this.distance * towards[k]);
  }

  look(name) {
    const { turn, pitch } = VIEWS[name];
    this.turn = (turn * Math.PI) / 180;
    this.pitch = (pitch * Math.PI) / 180;
  }

  orbit(dx, dy) {
    this.isOwn = true;
    this.turn -= dx * 0.008;
    this.pitch = clamp(this.pitch + dy * 0.008, -MAX_PITCH, MAX_PITCH);
  }

  pan(dx, dy, height) {
    this.isOwn = true;
    const scale = this.pixelMm(height);
    const { right, up } = this.axes;
    this.target = this.target.map((value, k) => value - scale * (dx * right[k] - dy * up[k]));
  }

  zoom(factor) {
    this.isOwn = true;
    this.distance = clamp(this.distance / factor, 5, 20000);
  }

  /** Shows a set of positions (x, y, z, x, ...) as large as they fit, with an empty border. */
  fit(positions, aspect) {
    if (!positions.length) return;
    const { right, up, towards } = this.axes;
    // a point at x aside is seen at a share x / (distance - z) of `slope`; the largest shares of both sides are equal
    const spans = [[right, SLOPE * aspect], [up, SLOPE]].map(([axis, slope]) => {
      let [low, high] = [-Infinity, -Infinity];
      const depth = this.isOrthographic ? 0 : slope / BORDER;
      for (let k = 0; k < positions.length; k += 3) {
        const [x, y, z] = [positions[k], positions[k + 1], positions[k + 2]];
        const aside = x * axis[0] + y * axis[1] + z * axis[2];
        const near = depth * (x * towards[0] + y * towards[1] + z * towards[2]);
        low = Math.max(low, near - aside);
        high = Math.max(high, near + aside);
      }
      return { middle: (high - low) / 2, distance: (BORDER * (high + low)) / (2 * slope) };
    });
    let [nearest, farthest] = [-Infinity, Infinity];
    for (let k = 0; k < positions.length; k += 3) {
      const z = positions[k] * towards[0] + positions[k + 1] * towards[1] + positions[k + 2] * towards[2];
      nearest = Math.max(nearest, z);
      farthest = Math.min(farthest, z);
    }
    const depth = (nearest + farthest) / 2;
    const [a, b] = spans.map(({ middle }) => middle);
    this.target = [0, 1, 2].map((c) => a * right[c] + b * up[c] + depth * towards[c]);
    this.distance = Math.max(5, ...spans.map(({ distance }) => distance - (this.isOrthographic ? 0 : depth)));
  }

  /** Whether all of a set of positions (x, y, z, x, ...) is in the picture. */
  shows(positions, aspect) {
    const { matrix: m } = this.frame(aspect);
    for (let k = 0; k < positions.length; k += 3) {
      const [x, y, w] = [0, 1, 3].map(
        (row) => m[row] * positions[k] + m[4 + row] * positions[k + 1] + m[8 + row] * positions[k + 2] + m[12 + row],
      );
      if (Math.max(Math.abs(x), Math.abs(y)) > w) return false;
    }
    return true;
  }

  /** Matrix from space to the picture, column by column, with what the shaders need. */
  frame(aspect) {
    const { right, up, towards } = this.axes;
    const { eye } = this;
    const view = [
      [right[0], up[0], towards[0], 0],
      [right[1], up[1], towards[1], 0],
      [right[2], up[2], towards[2], 0],
      [-dot(right, eye), -dot(up, eye), -dot(towards, eye), 1],
    ].flat();
    const [near, far] = [Math.max(0.5, this.distance / 40), this.distance * 8 + 4000];
    let projection;
    if (this.isOrthographic) {
      const size = SLOPE * this.distance;
      // depth from -1 to 1 over twice `far`, centred on the target, so that nothing is cut off
      projection = [1 / (size * aspect), 0, 0, 0, 0, 1 / size, 0, 0, 0, 0, -1 / far, 0, 0, 0, -this.distance / far, 1];
    } else {
      const [a, b] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
      projection = [1 / (SLOPE * aspect), 0, 0, 0, 0, 1 / SLOPE, 0, 0, 0, 0, a, -1, 0, 0, b, 0];
    }
    return { matrix: new Float32Array(multiply(projection, view)), eye, towards, isOrthographic: this.isOrthographic };
  }

  /** Ray through a place of the picture, from -1 to 1 in both directions. */
  ray([px, py], aspect) {
    const { right, up, towards } = this.axes;
    const [a, b] = [px * aspect * SLOPE, py * SLOPE];
    if (this.isOrthographic) {
      const start = this.eye.map((value, k) => value + this.distance * (a * right[k] + b * up[k]));
      return { start, direction: towards.map((value) => -value) };
    }
    const direction = towards.map((value, k) => a * right[k] + b * up[k] - value);
    return { start: this.eye, direction };
  }

  /** Place in the picture, -1 to 1, of a point in space. */
  project(point, aspect) {
    const { matrix } = this.frame(aspect);
    const [x, y, w] = [0, 1, 3].map(
      (row) => matrix[row] * point[0] + matrix[4 + row] * point[1] + matrix[8 + row] * point[2] + matrix[12 + row],
    );
    return [x / w, y / w];
  }

  /** Millimetres of a pixel at the target. */
  pixelMm(height) {
    return (2 * this.distance * SLOPE) / height;
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function multiply(a, b) {
  const product = new Array(16).fill(0);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      for (let k = 0; k < 4; k++) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return product;
}
