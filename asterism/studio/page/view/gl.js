// A thin layer over WebGL2: programs, buffers, maps of shadows, and one picture from a list of surfaces.

import { LIGHTS, LINE, SKY, SURFACE } from "./shaders.js";

const MAP_PX = 1024;
const MOST_SAMPLED_PX = 2e7; // a larger picture would take more than 1 GB
// in the order of their locations, which are those of all programs: name, numbers for each point
const ATTRIBUTES = [
  ["position", 3],
  ["normal", 3],
  ["colour", 4],
  ["printed", 2],
  ["sky", 2],
];

/** Directions to the lights: the sun to the left of the first view, then the sky, evenly spread. */
const WAYS = Array.from({ length: LIGHTS }, (_, k) => {
  if (k === 0) return unit([-0.62, -0.42, 0.72]);
  const [z, turn] = [(k - 0.5) / (LIGHTS - 1), 2.4 * k];
  return [Math.sqrt(1 - z * z) * Math.cos(turn), Math.sqrt(1 - z * z) * Math.sin(turn), z];
});

export class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: true });
    if (!gl) throw new Error("This browser has no WebGL 2. The sheet in space cannot be drawn.");
    this.gl = gl;
    this.largestPx = Math.min(gl.getParameter(gl.MAX_RENDERBUFFER_SIZE), ...gl.getParameter(gl.MAX_VIEWPORT_DIMS));
    this.surface = program(gl, SURFACE);
    this.line = program(gl, LINE);
    this.sky = program(gl, SKY);
    this.maps = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.maps);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.DEPTH_COMPONENT16, MAP_PX, MAP_PX, LIGHTS);
    for (const [name, value] of [
      [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ])
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, name, value);
    [this.target, this.sampled] = [gl.createFramebuffer(), gl.createFramebuffer()];
    this.unlit = gl.createVertexArray(); // attributes of points without their light: a drawn one may not be written to
    [this.colours, this.depths] = [gl.createRenderbuffer(), gl.createRenderbuffer()];
    this.seen = new Float32Array(16 * LIGHTS);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  /** A surface: buffers for positions, normals, colours, printed places, triangles and lines, filled by `fill`. */
  makeSurface() {
    const names = ["position", "normal", "colour", "printed", "sky", "triangles", "lines"];
    return { ...Object.fromEntries(names.map((name) => [name, this.gl.createBuffer()])), count: 0, lineCount: 0 };
  }

  /** The same points with other triangles. */
  withTriangles(surface) {
    return Object.assign(Object.create(surface), { triangles: this.gl.createBuffer(), count: 0 });
  }

  fill(surface, { positions, normals, colours, printed, triangles, lines }) {
    const { gl } = this;
    const put = (target, where, data) =>
      data && (gl.bindBuffer(target, where), gl.bufferData(target, data, gl.DYNAMIC_DRAW));
    put(gl.ARRAY_BUFFER, surface.position, positions);
    put(gl.ARRAY_BUFFER, surface.normal, normals);
    put(gl.ARRAY_BUFFER, surface.colour, colours);
    put(gl.ARRAY_BUFFER, surface.printed, printed);
    put(gl.ELEMENT_ARRAY_BUFFER, surface.triangles, triangles);
    put(gl.ELEMENT_ARRAY_BUFFER, surface.lines, lines);
    if (positions) Object.assign(surface, { points: positions.length / 3, hasSky: false });
    if (triangles) surface.count = triangles.length;
    if (lines) surface.lineCount = lines.length;
  }

  clear() {
    const { gl } = this;
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draws the map of the sun of all surfaces that cast shadows in a box {low, high}, for a picture with a `share` of the
   * pixels along each side. For a whole one also those of the sky; then each point has its share of the sky. */
  shade(surfaces, { low, high }, share) {
    const { gl } = this;
    const hasSky = share === 1;
    const side = hasSky ? MAP_PX : Math.round((share * MAP_PX) / 2); // of the part of a map that is used
    this.away = Math.max(0.15, (1.5 * Math.hypot(...high.map((value, c) => value - low[c]))) / side);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, side, side);
    gl.drawBuffers([gl.NONE]);
    gl.useProgram(this.line.program);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    for (let k = 0; k < (hasSky ? LIGHTS : 1); k++) {
      const matrix = lightMatrix(WAYS[k], low, high);
      const toPart = (value, n) => (n % 4 < 2 ? (side / MAP_PX) * (value + (n > 11)) - (n > 11) : value);
      this.seen.set(matrix.map(toPart), 16 * k);
      gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, this.maps, 0, k);
      gl.clear(gl.DEPTH_BUFFER_BIT);
      set(gl, this.line, { matrix, lift: 0 });
      for (const { surface, casts } of surfaces) if (casts) this.#elements(surface, gl.TRIANGLES);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    if (!hasSky) return;
    this.#use(this.sky);
    gl.bindVertexArray(this.unlit);
    gl.enable(gl.RASTERIZER_DISCARD);
    for (const { surface } of surfaces) {
      if (surface.hasSky || !surface.count) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, surface.sky);
      gl.bufferData(gl.ARRAY_BUFFER, 8 * surface.points, gl.DYNAMIC_COPY);
      this.#attributes(surface, ["position", "normal"]);
      gl.bindBuffer(gl.ARRAY_BUFFER, null); // a buffer that is written to has no other use
      gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, surface.sky);
      gl.beginTransformFeedback(gl.POINTS);
      gl.drawArrays(gl.POINTS, 0, surface.points);
      gl.endTransformFeedback();
      gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
      surface.hasSky = true;
    }
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindVertexArray(null);
  }

  /** Chooses a program that reads the maps. */
  #use(one) {
    const { gl, seen, away } = this;
    gl.useProgram(one.program);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.maps);
    set(gl, one, { ways: WAYS.flat(), seen, away, texel: 1 / MAP_PX });
  }

  /** Draws surfaces [{surface, base, ..}] as a camera sees them; `side`: only their "front" or "back" is drawn. */
  draw({ surfaces, camera, width, height, isSoft }) {
    const { gl } = this;
    const isSampled = isSoft && width * height < MOST_SAMPLED_PX;
    if (isSampled) this.#sample(width, height);
    gl.viewport(0, 0, width, height);
    this.clear();
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const { matrix, eye, towards, isOrthographic } = camera;
    this.#use(this.surface);
    set(gl, this.surface, { matrix, eye, towards, perspective: isOrthographic ? 0 : 1, soft: isSoft ? 1 : 0 });
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    for (const { surface, side, coloured = 0, alpha = 1, lift = 0, shine = 0.02, weave = 0, base, back = base } of surfaces) {
      set(gl, this.surface, { base, back, coloured, alpha, lift, shine, weave, hasSky: surface.hasSky ? 1 : 0 });
      if (side) gl.enable(gl.CULL_FACE);
      gl.cullFace(side === "back" ? gl.FRONT : gl.BACK);
      const extra = [coloured && "colour", weave && "printed", surface.hasSky && "sky"];
      this.#elements(surface, gl.TRIANGLES, ["position", "normal", ...extra]);
      gl.disable(gl.CULL_FACE);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.useProgram(this.line.program);
    for (const { surface, line, lift = 0 } of surfaces) {
      if (!line) continue;
      set(gl, this.line, { matrix, lift, base: line.slice(0, 3), alpha: line[3] });
      this.#elements(surface, gl.LINES);
    }
    gl.disable(gl.BLEND);
    if (!isSampled) return;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.sampled);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Draws into buffers with four samples a pixel. */
  #sample(width, height) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.sampled);
    if (String(this.size) === String([width, height])) return;
    this.size = [width, height];
    for (const [buffer, kind, place] of [
      [this.colours, gl.RGBA8, gl.COLOR_ATTACHMENT0],
      [this.depths, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, 4, kind, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
  }

  /** Waits until the picture is there, and returns the time. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now();
  }

  #elements(surface, kind, names = ["position", "normal"]) {
    const { gl } = this;
    const isLines = kind === gl.LINES;
    const count = isLines ? surface.lineCount : surface.count;
    if (!count) return;
    this.#attributes(surface, names);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, isLines ? surface.lines : surface.triangles);
    gl.drawElements(kind, count, gl.UNSIGNED_INT, 0);
  }

  /** Reads some of the attributes from a surface; the others are zero. */
  #attributes(surface, names) {
    const { gl } = this;
    ATTRIBUTES.forEach(([name, count], where) => {
      gl.disableVertexAttribArray(where);
      gl.vertexAttrib4f(where, 0, 0, 0, 0);
      if (!names.includes(name)) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, surface[name]);
      gl.enableVertexAttribArray(where);
      gl.vertexAttribPointer(where, count, count === 4 ? gl.UNSIGNED_BYTE : gl.FLOAT, count === 4, 0, 0);
    });
  }
}

/** Matrix, column by column, of a light that sees a whole box along a direction. */
function lightMatrix(way, low, high) {
  const right = unit([-way[1], way[0], 1e-9]);
  const up = [0, 1, 2].map((c) => way[(c + 1) % 3] * right[(c + 2) % 3] - way[(c + 2) % 3] * right[(c + 1) % 3]);
  const rows = [right, up, way.map((value) => -value)].map((axis) => {
    const [a, b] = [low, high].map((one, end) =>
      axis.reduce((sum, value, c) => sum + value * (value > 0 === (end === 1) ? high[c] : low[c]), 0),
    );
    const half = 0.51 * (b - a) + 1;
    return [...axis.map((value) => value / half), -(a + b) / (2 * half)];
  });
  return [0, 1, 2, 3].flatMap((c) => [...rows.map((row) => row[c]), c === 3 ? 1 : 0]);
}

function unit(vector) {
  const length = Math.hypot(...vector);
  return vector.map((value) => value / length);
}

function set(gl, { uniforms }, values) {
  for (const [name, value] of Object.entries(values)) {
    const { where, type } = uniforms[name] ?? {};
    if (type === gl.FLOAT) gl.uniform1f(where, value);
    else if (type === gl.FLOAT_VEC3) gl.uniform3fv(where, value);
    else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(where, false, value);
  }
}

function program(gl, { vertex, fragment, feedback }) {
  const whole = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(whole, shader);
  }
  ATTRIBUTES.forEach(([name], where) => gl.bindAttribLocation(whole, where, name));
  if (feedback) gl.transformFeedbackVaryings(whole, [feedback], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(whole);
  if (!gl.getProgramParameter(whole, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(whole));
  const uniforms = {};
  for (let k = 0; k < gl.getProgramParameter(whole, gl.ACTIVE_UNIFORMS); k++) {
    const { name, type } = gl.getActiveUniform(whole, k);
    uniforms[name.replace("[0]", "")] = { where: gl.getUniformLocation(whole, name), type };
  }
  return { program: whole, uniforms };
}
