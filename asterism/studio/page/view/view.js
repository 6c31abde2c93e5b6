// The sheet in space: takes frames, draws on demand, turns the camera, finds the star under the pointer.

import { DARK, isDark } from "../dom.js";
import { Renderer } from "./gl.js";
import { Camera } from "./camera.js";
import { box, contours, fieldValues, vertexNormals } from "./sheet.js";
import { FIELDS, fieldDomain, vertexColours } from "./colours.js";
import { pick, printedPlace } from "./picking.js";
import { FABRIC_MM, barColours, bars, board, headOf, needleSolids, parted, rim } from "./solids.js";
import { showLegend } from "./legend.js";

// colours of the two sides of the fabric, of its rim and of the other solids
const FABRIC = [
  [0.95, 0.91, 0.82],
  [0.66, 0.72, 0.8],
];
const GREY = [
  [0.82, 0.82, 0.81],
  [0.68, 0.69, 0.71],
];
const PLASTIC = [0.25, 0.26, 0.3];
const NEEDLE = [0.8, 0.22, 0.16];
const INK = [0.12, 0.12, 0.14];
const BOARDS = { light: [0.9, 0.89, 0.87], dark: [0.36, 0.37, 0.4] };
const NO_NEEDLES = new Float32Array(0);
const REST_MS = 250; // without a change, until the picture is drawn with all its light
const HELD_MS = 1500; // the same while a pointer is pressed: that picture takes long, and a stroke would wait for it
const QUICK_MS = 45; // longest picture of a moving sheet, if fewer pixels and less light make that possible
const MAX_MESHES = 8;
const MOVE_MS = 350; // in which the sheet moves over from the preview to the exact shape
const STALE_MS = 600; // without a newer shape, after which the shape of an older design is grey
const SMALL = 0.7; // of the size at which a sheet just fits: one that is smaller after a change is fitted again
const WIDE_ASPECT = 1.4; // in wider pictures the height of a sheet limits its size

export class View {
  camera = new Camera();
  meshes = new Map();
  shape = null; // arrays of the shown shape
  frames = 0;
  target = null; // the ghost beside the sheet: {surface, look}
  partner = null; // the other view, if two shapes are side by side
  #isDirty = false;
  #hasFit = false;
  #aspect = 0;
  #pixels = [0, 0];
  #drawn = null; // arrays of the sheet as it is drawn
  #box = null;
  #tops = []; // positions that the view shows
  #followed = []; // the same of the last shape that the camera has followed
  #corners = []; // of the board, which saved pictures show, too
  #level = 0; // of the board
  #light = 0; // shadows of the present shape: 1 of the sun, 2 also of the sky
  #fullMs = 0; // of the last picture with all its light
  #rest = 0;
  #isSaved = false; // whether what is drawn is a picture to save: its board is light, whatever the scheme of the page
  #share = 1; // of the way from the preview to the exact shape
  #staleTimer = 0;
  #agedFrame = null;
  isGrey = false;

  #ended = new AbortController();

  /** `leader`: the view whose camera and scale of colours this one shares. */
  constructor(canvas, store, { onFrame, legend, leader = null }) {
    Object.assign(this, { canvas, store, onFrame, legend, leader });
    if (leader) this.camera = leader.camera;
    this.renderer = new Renderer(canvas);
    for (const part of ["sheet", "contour", "rim", "arm", "needle", "board"])
      this[`${part}Surface`] = this.renderer.makeSurface();
    this.quickArms = this.renderer.withTriangles(this.armSurface);
    this.camera.isOrthographic = store.get("orthographic");
    const { signal } = this.#ended;
    const observer = new ResizeObserver(() => this.#resized());
    observer.observe(canvas);
    signal.addEventListener("abort", () => observer.disconnect());
    store.on(["viewColour", "showTarget"], () => this.#colour());
    store.on(["shown", "showBumps"], () => this.#place());
    store.on(["badge", "frame"], () => this.#age());
    store.on(["hover", "under", "selection"], () => this.#mark());
    store.on(["showArms", "theme"], () => this.invalidate());
    store.on(["orthographic"], ({ orthographic }) => {
      this.camera.isOrthographic = orthographic;
      this.invalidate();
    });
    matchMedia(DARK).addEventListener("change", () => this.invalidate(), { signal });
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
      isTaken = this.#takeShape(header, arrays);
    } finally {
      if (!isTaken) this.onFrame(header); // whatever happens: the server sends no other frame before
    }
  }

  /** Returns whether the shape will be drawn and confirmed. */
  #takeShape(header, arrays) {
    const mesh = this.meshes.get(header.mesh);
    if (!mesh) return false;
    this.meshes.delete(header.mesh);
    this.meshes.set(header.mesh, mesh); // the last one used goes last
    const normals = Object.keys(arrays).filter((name) => name.endsWith("arm_normals"));
    const units = Object.fromEntries(normals.map((name) => [name, unit(arrays[name])]));
    const isFirst = arrays.before && !(this.shape?.before && this.shape.header.revision === header.revision);
    this.shape = { ...arrays, ...units, arm_site: mesh.arm_site, mesh, header };
    header.hasBefore = Boolean(arrays.before);
    this.store.set({ frame: header });
    if (isFirst && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.#moveOver(this.shape);
    else this.#place();
    if (!this.leader && !this.#hasFit && this.#pixels[0]) this.fit(); // before its size is known there is nothing to fit to
    this.invalidate();
    return true;
  }

  /** Forgets the shape and the camera's place: another design is opened. */
  reset() {
    this.#hasFit = false;
    this.#confirm(); // the server sends no other shape before
    this.shape = null;
    this.renderer.clear();
    this.store.set({ shown: "shape" });
  }

  /** Moves the sheet from the preview to the exact shape. */
  #moveOver(shape) {
    const begun = performance.now();
    const step = () => {
      if (this.shape !== shape) return;
      this.#share = Math.min(1, (performance.now() - begun) / MOVE_MS);
      this.#place();
      if (this.#share < 1) requestAnimationFrame(step);
    };
    step();
  }

  /** A shape of an older design is grey, if no newer one follows soon. */
  #age() {
    const isStale = Boolean(this.store.get("badge")?.isStale);
    const { header } = this.shape ?? {};
    if (!isStale || header !== this.#agedFrame) {
      clearTimeout(this.#staleTimer);
      this.#staleTimer = 0;
      this.#setGrey(false);
    }
    this.#agedFrame = header;
    if (isStale && !this.#staleTimer && !this.isGrey) this.#staleTimer = setTimeout(() => this.#setGrey(true), STALE_MS);
  }

  #setGrey(isGrey) {
    if (this.isGrey === isGrey) return;
    this.isGrey = isGrey;
    this.invalidate();
  }

  /** Lets go of the canvas; a browser has few contexts for drawing. */
  close() {
    this.#ended.abort();
    this.renderer.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  get aspect() {
    return this.#pixels[0] / Math.max(1, this.#pixels[1]);
  }

  get positions() {
    return this.#drawn.positions;
  }

  /** Which of its sheets the shape shows: its own (""), the one without bumps, or the preview beside an exact shape. */
  get #part() {
    if (this.shape.before && this.store.get("shown") === "preview") return "before";
    return this.isSmooth ? "smooth" : "";
  }

  /** The arrays of a sheet of the shape. */
  #sheetOf(part) {
    const { shape } = this;
    const prefix = part && `${part}_`;
    const [arms, normals, needles] = ["arms", "arm_normals", "needles"].map((name) => shape[prefix + name] ?? NO_NEEDLES);
    return { positions: shape[part || "positions"], arms, normals, needles };
  }

  /** Whether the sheet is shown without its bumps; until the server has sent that, it is shown with them. */
  get isSmooth() {
    return !this.store.get("showBumps") && Boolean(this.shape?.smooth);
  }

  get triangles() {
    return this.shape.mesh.triangles;
  }

  /** Fills the buffers of the sheet, its arms and needles, and the board. */
  #place() {
    if (!this.shape) return;
    this.#light = 0;
    const part = this.#part;
    this.#drawn = this.#sheetOf(part);
    if (this.shape.before && !part && this.#share < 1) this.#drawn = between(this.#sheetOf("before"), this.#drawn, this.#share);
    const { arms, normals: armNormals, needles } = this.#drawn;
    const { positions, triangles, renderer } = this;
    const { printed, outline } = this.shape.mesh;
    const normals = vertexNormals(positions, triangles);
    renderer.fill(this.sheetSurface, { positions, normals, printed, triangles, lines: outline });
    renderer.fill(this.rimSurface, rim(positions, normals, outline));
    const made = arms.length ? bars(arms, armNormals, arms.rows) : null;
    this.shape.perArm = made?.perArm;
    if (made) {
      renderer.fill(this.armSurface, made);
      renderer.fill(this.quickArms, { triangles: made.few });
    } else this.armSurface.count = 0;
    const tops = [...positions];
    const held = parted(needles);
    for (const [, tip] of held.upright) tops.push(...headOf(tip));
    this.#box = box(tops); // around all that casts shadows
    this.#level = Math.min(0, this.#box.low[2]) - FABRIC_MM - 0.1;
    const table = board(this.#box, held, this.#level);
    renderer.fill(this.needleSurface, needleSolids(held, this.#level));
    renderer.fill(this.boardSurface, table);
    this.#tops = tops;
    this.#corners = table.corners;
    this.#follow();
    this.#mark();
    this.#colour();
  }

  /** The field that colours the sheet. */
  get field() {
    if (this.shape.before && this.store.get("shown") === "distance") return "distance";
    return this.store.get("viewColour");
  }

  /** The values of a field; null if the shape has none. */
  #valuesOf(name) {
    if (name === "none" || !this.shape) return null;
    const values = fieldValues(name, { ...this.shape, positions: this.positions, exact: this.shape.positions });
    return values?.length === this.positions.length / 3 ? values : null;
  }

  /** Colours, and lines of equal distance where the sheet is compared with another surface. */
  #colour() {
    if (!this.shape) return;
    if (this.leader) return this.partner?.#colour();
    const { field: name, partner } = this;
    const values = [this, partner].map((view) => view?.#valuesOf(name) ?? null);
    const domain = values[0] && fieldDomain(name, values.flatMap((some) => (some ? [...some] : [])));
    [this, partner].forEach((view, k) => view?.shape && view.#paint(name, values[k], domain));
    const { isDistance } = FIELDS[name];
    const compared = isDistance ? values[0] : this.store.get("showTarget") && this.#valuesOf("target");
    const lines = compared
      ? contours(this.positions, this.triangles, compared, (isDistance ? domain : fieldDomain("target", compared))[1] / 8)
      : new Float32Array(0);
    this.renderer.fill(this.contourSurface, {
      positions: lines,
      normals: lines,
      lines: Uint32Array.from({ length: lines.length / 3 }, (_, k) => k),
    });
    showLegend(this.legend, values[0] ? name : "none", domain);
    this.invalidate();
  }

  #paint(name, values, domain) {
    this.isColoured = Boolean(values && domain);
    if (this.isColoured) this.renderer.fill(this.sheetSurface, { colours: vertexColours(name, values, domain) });
  }

  #mark() {
    const sites = this.shape?.arm_site;
    const sheet = this.store.get("sheet");
    if (!sites || !sheet || !this.shape.perArm) return;
    const [hover, under, selection] = ["hover", "under", "selection"].map((name) => this.store.get(name));
    const isMarked = (row) => {
      const key = sheet.stars[row]?.key;
      return key !== undefined && (key === hover || under.has(key) || selection.has(key));
    };
    this.renderer.fill(this.armSurface, { colours: barColours(sites, this.shape.perArm, isMarked) });
    this.invalidate();
  }

  /** All positions to show, also of the sheet beside this one. */
  get #shown() {
    return this.partner?.shape ? [...this.#tops, ...this.partner.#tops] : this.#tops;
  }

  fit() {
    if (!this.shape) return;
    this.camera.fit(this.#shown, this.aspect);
    this.camera.isOwn = false;
    this.#hasFit = true;
    this.invalidate();
  }

  /** Fits again a sheet that has left the picture or is much smaller; what a hand has chosen stays as long as it shows
   * what it showed before, and nothing moves under a hand that drags. */
  #follow() {
    const { camera, aspect, leader } = this;
    const isMoving = document.body.matches(":active") || this.#share < 1;
    if (leader || !this.#hasFit || isMoving || this.shape.header.stage === "linear") return;
    const [before, now] = [this.#followed, this.#shown];
    this.#followed = now;
    const isOut = !camera.shows(now, aspect);
    const fitted = Object.assign(new Camera(), camera);
    fitted.fit(now, aspect);
    const isSmall = fitted.distance < SMALL * camera.distance;
    if (camera.isOwn ? isOut && camera.shows(before, aspect) : isOut || isSmall) Object.assign(camera, fitted);
  }

  look(name) {
    this.camera.look(name);
    this.fit();
  }

  /** Draws soon, and again with all light and pixels when nothing has changed for a while. */
  invalidate() {
    if (this.#isDirty) return;
    this.#isDirty = true;
    this.partner?.invalidate();
    requestAnimationFrame(() => {
      this.#isDirty = false;
      if (this.#fullMs < QUICK_MS) return this.draw();
      this.draw(Math.max(0.4, Math.sqrt(QUICK_MS / this.#fullMs)));
      this.#drawAtRest();
    });
  }

  /** Draws with all light and pixels after a while; later if a pointer is pressed, as the next change is then near. */
  #drawAtRest(since = performance.now()) {
    clearTimeout(this.#rest);
    this.#rest = setTimeout(() => {
      const isHeld = document.body.matches(":active") && performance.now() - since < HELD_MS;
      isHeld ? this.#drawAtRest(since) : this.draw();
    }, REST_MS);
  }

  /** Draws on a `share` of the canvas' pixels along each side; with less than all, a new shape has no shadows of the sky. */
  draw(share = 1, pixels = this.#pixels) {
    const { canvas, renderer } = this;
    const [width, height] = pixels.map((side) => Math.round(side * share));
    if (!this.shape || !width) return this.#confirm();
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const surfaces = this.#surfaces(share < 1);
    const light = share < 1 ? 1 : 2;
    if (this.#light < light) renderer.shade(surfaces, this.#box, share);
    this.#light = Math.max(light, this.#light);
    const start = share === 1 && renderer.finish();
    renderer.draw({ surfaces, camera: this.camera.frame(pixels[0] / pixels[1]), width, height, isSoft: share === 1 });
    if (share === 1) this.#fullMs = renderer.finish() - start; // without the maps: these follow a new shape only
    this.frames += 1;
    this.#confirm();
  }

  /** What is drawn; `isQuick`: the fabric without its thickness, arms of fewer pieces and without shadows. */
  #surfaces(isQuick) {
    const { isGrey } = this;
    const [front, back] = isGrey ? GREY : FABRIC;
    const coloured = this.isColoured && !isGrey ? 1 : 0;
    const sheet = { surface: this.sheetSurface, coloured, weave: coloured ? 0 : 0.04 };
    const surfaces = [];
    if (this.camera.eye[2] > this.#level)
      surfaces.push({
        surface: this.boardSurface,
        base: BOARDS[isDark(this.canvas) && !this.#isSaved ? "dark" : "light"],
        line: [...INK, 0.45],
      });
    const top = { ...sheet, base: front, back, line: [...INK, 0.8], casts: true };
    if (isQuick) surfaces.push(top);
    else
      surfaces.push(
        { ...top, side: "front" },
        { ...sheet, side: "back", base: back, lift: -FABRIC_MM, line: [...INK, 0.5] },
        { surface: this.rimSurface, base: front.map((value) => 0.92 * value) },
      );
    surfaces.push({ surface: this.needleSurface, base: NEEDLE, shine: 0.3, casts: true });
    const arms = isQuick ? this.quickArms : this.armSurface;
    if (this.store.get("showArms") && this.armSurface.count)
      surfaces.push({ surface: arms, base: PLASTIC, shine: 0.1, coloured: 1, casts: !isQuick });
    if (this.contourSurface.lineCount && !isGrey)
      surfaces.push({ surface: this.contourSurface, base: INK, line: coloured ? [1, 1, 1, 0.8] : [...INK, 0.8] });
    if (this.target && this.store.get("showTarget")) surfaces.push({ surface: this.target.surface, ...this.target.look });
    return surfaces;
  }

  /** Tells once that a shape is drawn, or that it will not be. */
  #confirm() {
    if (!this.shape || this.shape.header.isConfirmed) return;
    this.shape.header.isConfirmed = true;
    this.onFrame(this.shape.header);
  }

  #resized() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !height) return;
    const [before, now] = [this.#aspect, width / height].map((aspect) => Math.min(aspect, WIDE_ASPECT));
    if (!this.leader && this.#hasFit && before) this.camera.distance *= before / now; // a narrow window shows the same width
    this.#aspect = width / height;
    this.#pixels = [Math.round(width * ratio), Math.round(height * ratio)];
    if (!this.leader && !this.#hasFit) this.fit();
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
    if (!this.shape) return null;
    const hit = pick(this.camera.ray(this.place(event), this.aspect), this.positions, this.triangles);
    return hit && printedPlace(hit, this.shape.mesh.printed, this.triangles);
  }

  /** A picture of the view at a chosen size, as PNG, drawn with twice the pixels; `title`: also with a scale bar.
   * A small one is of the plain sheet, from the usual side. */
  picture(width, height, { background, title = null, isSmall = false }) {
    const { camera } = this;
    this.camera = Object.assign(new Camera(), isSmall ? {} : camera);
    this.camera.fit(isSmall ? this.#tops : [...this.#tops, ...this.#corners], width / height);
    if (isSmall) this.isColoured = false;
    this.#isSaved = !isSmall;
    const fine = 2 * Math.max(width, height) <= this.renderer.largestPx ? 2 : 1;
    if (isSmall) this.draw(0.5, [4 * width, 4 * height]); // quick, on twice the pixels
    else this.draw(1, [fine * width, fine * height]);
    const flat = document.createElement("canvas");
    [flat.width, flat.height] = [width, height];
    const context = flat.getContext("2d");
    context.imageSmoothingQuality = "high";
    if (background) {
      context.fillStyle = background;
      context.fillRect(0, 0, width, height);
    }
    context.drawImage(this.canvas, 0, 0, width, height);
    if (title !== null) caption(context, title, this.camera.pixelMm(height));
    this.camera = camera;
    this.#isSaved = false;
    if (!isSmall) this.draw();
    return new Promise((resolve) => flat.toBlob(resolve, "image/png"));
  }
}

/** Writes a title, and a bar of a round length, whose scale is that at the middle of the sheet. */
function caption(context, title, pixelMm) {
  const { width, height } = context.canvas;
  const unit = Math.min(width, height) / 45;
  const most = (0.25 * width * pixelMm) / 10;
  const power = 10 ** Math.floor(Math.log10(most * 10));
  const length = [5, 2, 1].find((step) => step * power <= 10 * most) * power;
  context.fillStyle = "#26262b";
  context.font = `600 ${1.3 * unit}px system-ui, sans-serif`;
  context.fillText(title, 1.5 * unit, 2.5 * unit);
  context.font = `${unit}px system-ui, sans-serif`;
  context.fillText(`${length} mm`, 1.5 * unit, height - 2.2 * unit);
  context.fillRect(1.5 * unit, height - 1.7 * unit, length / pixelMm, unit / 5);
}

/** The arrays of a sheet on its way from one to another. */
function between(from, to, share) {
  const part = (name) => {
    const mixed = to[name].map((end, k) => (1 - share) * from[name][k] + share * end);
    return Object.assign(mixed, { rows: to[name].rows });
  };
  return Object.fromEntries(Object.keys(to).map((name) => [name, part(name)]));
}

/** Unit vectors that came as whole numbers up to 127. */
function unit(normals) {
  return normals instanceof Int8Array ? Float32Array.from(normals, (value) => value / 127) : normals;
}
