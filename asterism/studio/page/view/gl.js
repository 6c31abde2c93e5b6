// A thin layer over WebGL2: programs, buffers, and one picture from a list of surfaces.

import { BLUR, GROUND, SHADOW, SURFACE } from "./shaders.js";

const SHADOW_PX = 256;
const BLUR_SHARE = 1 / 190; // of the map's width, between two samples of the blur

export class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", {
      antialias: true,
      alpha: true,
      premultipliedAlpha: true,
      preserveDrawingBuffer: false,
    });
    if (!gl) throw new Error("This browser has no WebGL 2. The sheet in space cannot be drawn.");
    this.gl = gl;
    this.largestPx = Math.min(gl.getParameter(gl.MAX_RENDERBUFFER_SIZE), ...gl.getParameter(gl.MAX_VIEWPORT_DIMS));
    this.canvas = canvas;
    this.surface = program(gl, SURFACE);
    this.ground = program(gl, GROUND);
    this.shadow = program(gl, SHADOW);
    this.blur = program(gl, BLUR);
    this.quad = buffer(gl, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    [this.sharp, this.half, this.soft] = [1, 2, 3].map(() => this.#makeMap());
  }

  /** A square picture of shadows that can be drawn into. */
  #makeMap() {
    const { gl } = this;
    const [texture, target] = [gl.createTexture(), gl.createFramebuffer()];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, SHADOW_PX, SHADOW_PX, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { texture, target };
  }

  /** A surface: buffers for positions, normals, colours and triangles, filled by `fill`. */
  makeSurface() {
    const { gl } = this;
    return {
      position: gl.createBuffer(),
      normal: gl.createBuffer(),
      colour: gl.createBuffer(),
      triangles: gl.createBuffer(),
      count: 0,
    };
  }

  fill(surface, { positions, normals, colours, triangles }) {
    const { gl } = this;
    const put = (target, where, data) => (gl.bindBuffer(target, where), gl.bufferData(target, data, gl.DYNAMIC_DRAW));
    if (positions) put(gl.ARRAY_BUFFER, surface.position, positions);
    if (normals) put(gl.ARRAY_BUFFER, surface.normal, normals);
    if (colours) put(gl.ARRAY_BUFFER, surface.colour, colours);
    if (triangles) {
      put(gl.ELEMENT_ARRAY_BUFFER, surface.triangles, triangles);
      surface.count = triangles.length;
    }
  }

  clear() {
    const { gl } = this;
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draws everything. `scene`: {surfaces: [{surface, front, back, ..}], ground, camera, matrix, clear}. */
  draw({ surfaces, ground, camera, width, height }) {
    const { gl } = this;
    const caster = surfaces.find((one) => one.isCaster);
    if (ground && caster) this.#drawShadow(caster.surface, ground);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    if (ground && camera.eye[2] > ground.level) this.#drawGround(ground, camera);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.surface.program);
    this.#set(this.surface, {
      matrix: camera.matrix,
      eye: camera.eye,
      towards: camera.towards,
      perspective: camera.isOrthographic ? 0 : 1,
    });
    for (const one of surfaces) this.#drawSurface(one);
    gl.disable(gl.DEPTH_TEST);
  }

  #drawSurface({ surface, front, back, coloured = 0, alpha = 1, lift = 0, shine = 0.05, isBehind = false }) {
    if (!surface.count) return;
    const { gl } = this;
    this.#set(this.surface, { front, back, coloured, alpha, lift, shine });
    this.#attribute(this.surface, "position", surface.position, 3, gl.FLOAT);
    this.#attribute(this.surface, "normal", surface.normal, 3, gl.FLOAT);
    if (coloured) this.#attribute(this.surface, "colour", surface.colour, 4, gl.UNSIGNED_BYTE, true);
    else {
      gl.disableVertexAttribArray(this.surface.attributes.colour);
      gl.vertexAttrib4f(this.surface.attributes.colour, 0, 0, 0, 0);
    }
    if (isBehind) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, surface.triangles);
    gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  #drawShadow(surface, { centre, reach }) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.sharp.target);
    gl.viewport(0, 0, SHADOW_PX, SHADOW_PX);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.disable(gl.BLEND);
    gl.useProgram(this.shadow.program);
    this.#set(this.shadow, { centre, reach });
    this.#attribute(this.shadow, "position", surface.position, 3, gl.FLOAT);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, surface.triangles);
    gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    this.#blur(this.sharp, this.half, [BLUR_SHARE, 0]);
    this.#blur(this.half, this.soft, [0, BLUR_SHARE]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  #blur(from, into, way) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, into.target);
    gl.useProgram(this.blur.program);
    gl.bindTexture(gl.TEXTURE_2D, from.texture);
    this.#set(this.blur, { way });
    this.#attribute(this.blur, "corner", this.quad, 2, gl.FLOAT);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  #drawGround({ centre, reach, level, line, lineAlpha, shade, stepMm }, camera) {
    const { gl } = this;
    gl.useProgram(this.ground.program);
    gl.bindTexture(gl.TEXTURE_2D, this.soft.texture);
    this.#set(this.ground, { matrix: camera.matrix, centre, reach, level, line, lineAlpha, shade, stepMm });
    this.#attribute(this.ground, "corner", this.quad, 2, gl.FLOAT);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  #attribute({ attributes }, name, from, count, type, isNormalised = false) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, from);
    gl.enableVertexAttribArray(attributes[name]);
    gl.vertexAttribPointer(attributes[name], count, type, isNormalised, 0, 0);
  }

  #set({ uniforms }, values) {
    const { gl } = this;
    for (const [name, value] of Object.entries(values)) {
      const where = uniforms[name];
      if (where === undefined || value === undefined) continue;
      if (typeof value === "number") gl.uniform1f(where, value);
      else if (value.length === 16) gl.uniformMatrix4fv(where, false, value);
      else if (value.length === 3) gl.uniform3fv(where, value);
      else gl.uniform2fv(where, value);
    }
  }
}

function program(gl, { vertex, fragment }) {
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
  gl.linkProgram(whole);
  if (!gl.getProgramParameter(whole, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(whole));
  const [attributes, uniforms] = [{}, {}];
  for (let k = 0; k < gl.getProgramParameter(whole, gl.ACTIVE_ATTRIBUTES); k++) {
    const { name } = gl.getActiveAttrib(whole, k);
    attributes[name] = gl.getAttribLocation(whole, name);
  }
  for (let k = 0; k < gl.getProgramParameter(whole, gl.ACTIVE_UNIFORMS); k++) {
    const { name } = gl.getActiveUniform(whole, k);
    uniforms[name] = gl.getUniformLocation(whole, name);
  }
  return { program: whole, attributes, uniforms };
}

function buffer(gl, data) {
  const made = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, made);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  return made;
}
