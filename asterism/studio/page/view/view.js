// The sheet in space: takes frames, draws on demand, turns the camera, finds the star under the pointer.

import { Renderer } from "./gl.js";
import { Camera } from "./camera.js";
import { armColours, ribbons } from "./arms.js";
import { box, fieldValues, vertexNormals } from "./sheet.js";
import { fieldDomain, vertexColours } from "./colours.js";
import { needleSurface } from "./needles.js";
import { pick, printedPlace } from "./picking.js";
import { showLegend } from "./legend.js";

const FABRIC = { front: [0.94, 0.9, 0.81], back: [0.72, 0.76, 0.8] };
const GREY = { front: [0.8, 0.8, 0.79], back: [0.66, 0.67, 0.69] };
const PLASTIC = [0.15, 0.16, 0.19];
const NEEDLE = [0.78, 0.2, 0.15];
const EXACT = [0.25, 0.43, 0.88];
const MAX_MESHES = 8;
const WIDE_ASPECT = 1.4; // in wider pictures the height of a sheet limits its size

export class View {
  camera = new Camera();
  meshes = new Map();
  shape = null; // arrays of the shown shape
  frames = 0;
  drawMs = 0;
  target = null; // the ghost beside the sheet: {surface, look}
  #isDirty = false;
  #hasFit = false;
  #aspect = 0;
  #caster = null;

  #ended = new AbortController();

  constructor(canvas, store, { onFrame, legend }) {
    this.canvas = canvas;
    this.legend = legend;
    this.store = store;
    this.onFrame = onFrame;
    this.renderer = new Renderer(canvas);
    this.sheetSurface = this.renderer.makeSurface();
    this.exactSurface = this.renderer.makeSurface();
    this.armSurface = this.renderer.makeSurface();
    this.needleSurface = this.renderer.makeSurface();
    this.camera.isOrthographic = store.get("orthographic");
    const observer = new ResizeObserver(() => this.#resized());
    observer.observe(canvas);
    this.#ended.signal.addEventListener("abort", () => observer.disconnect());
    store.on(["viewColour", "comparison"], () => this.#colour());
    store.on(["shown", "comparison", "showBumps"], () => this.#place());
    store.on(["hover", "selection"], () => this.#mark());
    store.on(["showArms", "theme", "problem", "connection"], () => this.invalidate());
    store.on(["orthographic"], ({ orthographic }) => {
      this.camera.isOrthographic = orthographic;
      this.invalidate();
    });
    const { signal } = this.#ended;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.invalidate(), { signal });
  }

  /** A binary frame of the server. */
  take({ kind, header, arrays }) {
    if (kind === 1) {
      this.meshes.set(header.mesh, arrays);
      if (this.meshes.size > MAX_MESHES) this.meshes.delete(this.meshes.keys().next().value);
      return;
    }
    let isTaken = false;
    try {
      if (kind === 2) isTaken = this.#takeShape(header, arrays);
      else this.#takeComparison(header, arrays);
    } finally {
      if (!isTaken) this.onFrame(header); // whatever happens: the server sends no other frame before
    }
  }

  #takeComparison({ mesh, revision }, arrays) {
    if (this.shape) bringTo(this.shape.positions, arrays);
    const isOld = revision !== this.store.get("document")?.revision;
    this.store.set({
      comparison: { ...arrays, mesh, revision, isOld },
      viewColour: "distance",
      shown: "exact",
    });
  }

  /** Returns whether the shape will be drawn and confirmed. */
  #takeShape(header, arrays) {
    const mesh = this.meshes.get(header.mesh);
    if (!mesh) return false;
    const { arm_normals: normals, smooth_arm_normals: smoothNormals } = arrays;
    this.shape = { ...arrays, arm_normals: unit(normals), arm_site: mesh.arm_site, mesh, header };
    if (arrays.smooth) this.shape.smooth_arm_normals = unit(smoothNormals);
    this.store.set({ frame: header });
    this.#place();
    if (!this.#hasFit && this.canvas.clientWidth) this.fit();
    this.invalidate();
    return true;
  }

  /** Forgets the shape and the camera's place: another design is opened. */
  reset() {
    this.#hasFit = false;
    this.#confirm(); // the server sends no other shape before
    this.shape = null;
    this.renderer.clear();
    this.store.set({ comparison: null, shown: "preview" });
    if (this.store.get("viewColour") === "distance") this.store.set({ viewColour: "none" });
  }

  /** Lets go of the canvas; a browser has few contexts for drawing. */
  close() {
    this.#ended.abort();
    this.renderer.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  get aspect() {
    return this.canvas.width / Math.max(1, this.canvas.height);
  }

  get positions() {
    const comparison = this.store.get("comparison");
    const shown = this.store.get("shown");
    if (comparison && shown === "exact") return comparison.exact;
    if (comparison && shown === "both") return comparison.preview;
    return this.isSmooth ? this.shape.smooth : this.shape.positions;
  }

  /** Whether the sheet is shown without its bumps; until the server has sent that, it is shown with them. */
  get isSmooth() {
    return !this.store.get("showBumps") && Boolean(this.shape?.smooth);
  }

  get triangles() {
    const comparison = this.store.get("comparison");
    if (comparison && this.store.get("shown") !== "preview")
      return (this.meshes.get(comparison.mesh) ?? this.shape.mesh).triangles;
    return this.shape.mesh.triangles;
  }

  /** Fills the buffers of positions, ribbons and needles. */
  #place() {
    if (!this.shape) return;
    const part = this.isSmooth ? "smooth_" : "";
    const [arms, armNormals, needles] = ["arms", "arm_normals", "needles"].map((name) => this.shape[part + name]);
    const { positions, triangles, renderer } = this;
    renderer.fill(this.sheetSurface, { positions, normals: vertexNormals(positions, triangles), triangles });
    const comparison = this.store.get("comparison");
    if (comparison) {
      const mesh = this.meshes.get(comparison.mesh) ?? this.shape.mesh;
      renderer.fill(this.exactSurface, {
        positions: comparison.exact,
        normals: vertexNormals(comparison.exact, mesh.triangles),
        triangles: mesh.triangles,
      });
    }
    this.#caster = box(positions);
    if (arms?.length) {
      const made = ribbons(arms, armNormals, arms.rows);
      this.shape.stations = made.stations;
      renderer.fill(this.armSurface, made);
    } else this.armSurface.count = 0;
    const size = Math.hypot(this.#caster.high[0] - this.#caster.low[0], this.#caster.high[1] - this.#caster.low[1]);
    renderer.fill(this.needleSurface, needleSurface(needles ?? new Float32Array(0), size));
    this.#mark();
    this.#colour();
  }

  #colour() {
    if (!this.shape) return;
    const name = this.store.get("viewColour");
    const comparison = this.store.get("comparison");
    const shape = { ...this.shape, positions: this.positions };
    const values = name === "none" ? null : fieldValues(name, shape, comparison);
    this.isColoured = Boolean(values) && values.length === this.positions.length / 3;
    let domain = null;
    if (this.isColoured) {
      domain = fieldDomain(name, values);
      this.renderer.fill(this.sheetSurface, { colours: vertexColours(name, values, domain) });
    }
    showLegend(
      this.legend,
      this.isColoured && this.store.get("shown") !== "both" ? name : "none",
      domain,
    );
    this.invalidate();
  }

  #mark() {
    const sites = this.shape?.arm_site;
    const sheet = this.store.get("sheet");
    if (!sites || !sheet || !this.shape.stations) return;
    const hover = this.store.get("hover");
    const selection = this.store.get("selection");
    const isMarked = (row) => {
      const key = sheet.stars[row]?.key;
      return key !== undefined && (key === hover || selection.has(key));
    };
    this.renderer.fill(this.armSurface, { colours: armColours(sites, this.shape.stations, isMarked) });
    this.invalidate();
  }

  fit() {
    if (!this.shape) return;
    this.camera.fit(this.positions, this.aspect);
    this.#hasFit = true;
    this.invalidate();
  }

  look(name) {
    this.camera.look(name);
    this.fit();
  }

  invalidate() {
    if (this.#isDirty) return;
    this.#isDirty = true;
    requestAnimationFrame(() => {
      this.#isDirty = false;
      this.draw();
    });
  }

  draw(width = this.canvas.width, height = this.canvas.height) {
    if (!this.shape || !width) return this.#confirm();
    const start = performance.now();
    const isGrey = this.store.get("problem")?.isBlocking || this.store.get("connection") === "lost";
    const shown = this.store.get("comparison") ? this.store.get("shown") : "preview";
    const colours = isGrey ? GREY : FABRIC;
    const marked = this.shape.arm_site ? 1 : 0;
    const surfaces = [
      {
        surface: this.sheetSurface,
        ...colours,
        coloured: this.isColoured && !isGrey && shown !== "both" ? 1 : 0,
        isCaster: true,
        isBehind: true,
      },
    ];
    if (this.store.get("showArms") && shown === "preview" && this.armSurface.count) {
      surfaces.push({
        surface: this.armSurface,
        front: PLASTIC,
        back: PLASTIC,
        lift: 0.15,
        shine: 0.16,
        coloured: marked,
      });
    }
    surfaces.push({ surface: this.needleSurface, front: NEEDLE, back: NEEDLE, shine: 0.3 });
    if (shown === "both") surfaces.push({ surface: this.exactSurface, front: EXACT, back: EXACT, alpha: 0.45 });
    if (this.target && this.store.get("showTarget")) surfaces.push({ surface: this.target.surface, ...this.target.look });
    this.renderer.draw({ surfaces, ground: this.#ground(), camera: this.camera.frame(width / height), width, height });
    this.drawMs = performance.now() - start;
    this.frames += 1;
    this.#confirm();
  }

  /** Tells once that a shape is drawn, or that it will not be. */
  #confirm() {
    if (!this.shape || this.shape.header.isConfirmed) return;
    this.shape.header.isConfirmed = true;
    this.onFrame(this.shape.header);
  }

  #ground() {
    const { low, high } = this.#caster;
    const isDark = getComputedStyle(this.canvas).colorScheme.trim() === "dark";
    const size = Math.hypot(high[0] - low[0], high[1] - low[1]);
    return {
      centre: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2],
      reach: 1.15 * size,
      level: Math.min(0, low[2]) - 0.4,
      line: isDark ? [0.85, 0.87, 0.9] : [0.2, 0.22, 0.26],
      lineAlpha: isDark ? 0.14 : 0.2,
      shade: isDark ? 0.6 : 0.34,
      stepMm: size > 400 ? 50 : 10,
    };
  }

  #resized() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !height) return;
    const [before, now] = [this.#aspect, width / height].map((aspect) => Math.min(aspect, WIDE_ASPECT));
    if (this.#hasFit && before) this.camera.distance *= before / now; // a narrow window shows the same width
    this.#aspect = width / height;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    if (!this.#hasFit) this.fit();
    this.draw();
  }

  /** Place in the picture, -1 to 1, of a pointer event. */
  place(event) {
    const frame = this.canvas.getBoundingClientRect();
    return [(2 * (event.clientX - frame.left)) / frame.width - 1, 1 - (2 * (event.clientY - frame.top)) / frame.height];
  }

  /** Place on the canvas, in px, of a point in space. */
  toScreen(point) {
    const [x, y] = this.camera.project(point, this.aspect);
    return [((x + 1) / 2) * this.canvas.clientWidth, ((1 - y) / 2) * this.canvas.clientHeight];
  }

  /** The printed place under a pointer event, or null. */
  printedAt(event) {
    if (!this.shape || this.positions.length !== this.shape.mesh.printed.length * 1.5) return null;
    const hit = pick(this.camera.ray(this.place(event), this.aspect), this.positions, this.triangles);
    return hit && printedPlace(hit, this.shape.mesh.printed, this.triangles);
  }

  /** A picture of the view at a chosen size, as PNG. */
  picture(width, height, background) {
    const { canvas } = this;
    const before = [canvas.width, canvas.height];
    [canvas.width, canvas.height] = [width, height];
    const { target, distance } = this.camera;
    this.camera.fit(this.positions, width / height);
    this.draw(width, height);
    Object.assign(this.camera, { target, distance });
    const flat = document.createElement("canvas");
    [flat.width, flat.height] = [width, height];
    const context = flat.getContext("2d");
    if (background) {
      context.fillStyle = background;
      context.fillRect(0, 0, width, height);
    }
    context.drawImage(canvas, 0, 0);
    [canvas.width, canvas.height] = before;
    this.draw();
    return new Promise((resolve) => flat.toBlob(resolve, "image/png"));
  }
}

/** Moves both shapes of a verification to the middle of the shown one, so that the picture stays where it is. */
function bringTo(positions, { exact, preview }) {
  const [one, other] = [box(positions), box(preview)];
  for (let k = 0; k < exact.length; k++) {
    const c = k % 3;
    const move = (one.low[c] + one.high[c] - other.low[c] - other.high[c]) / 2;
    exact[k] += move;
    preview[k] += move;
  }
}

/** Unit vectors that came as whole numbers up to 127. */
function unit(normals) {
  return normals instanceof Int8Array ? Float32Array.from(normals, (value) => value / 127) : normals;
}
