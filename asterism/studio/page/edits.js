// Changes of the document: drawn at once, sent at most every 30 ms, one gesture number from pointer down to up.

import { QUANTITIES } from "./format.js";
import { brushed } from "./rods.js";
import { emptyLocal, Sheet } from "./sheet.js";

const INTERVAL_MS = 30;

export class Edits {
  isOpen = false; // a gesture
  #local = emptyLocal();
  #gesture = 0;
  #sent = 0; // last gesture that ended here
  #arrived = 0; // last gesture of here that a document contained
  #waiting = new Map(); // messages of this gesture that are not sent yet, by kind
  #timer = 0;
  #kept = []; // messages for which there was no connection

  constructor(store, connection) {
    Object.assign(this, { store, connection });
  }

  /** Whether a gesture that ended here is not in the document yet. */
  get isWaiting() {
    return this.isOpen || this.#arrived < this.#sent;
  }

  begin() {
    if (!this.isOpen) {
      this.#gesture += 1;
      this.isOpen = true;
    }
    return this.#gesture;
  }

  /** Sizes of one quantity: Map(key -> mm). */
  sizes(quantity, values) {
    const { key: field } = QUANTITIES[quantity];
    for (const [key, value] of values) {
      this.#local.sizes.set(key, { ...this.#local.sizes.get(key), [field]: value });
      this.#local.reset.delete(key);
    }
    this.#gather("sizes", values, quantity);
  }

  /** The brush over rods: {size, mode, radius, strength, value, low, high}, put down at the images of one place. Rods of the names `kept` keep their sizes. */
  brush(brush, images, kept) {
    this.#local.rods = brushed(this.store.get("sheet").rods, brush, images, kept);
    const name = `brush ${brush.value}`; // Alt changes its sign
    const places = this.#waiting.get(name)?.fields.places ?? [];
    this.#later("brush", { ...brush, places: [...places, images] }, name);
  }

  remove(keys) {
    this.#mark("remove", keys, (key) => this.#local.removed.set(key, true));
  }

  restore(keys) {
    this.#mark("restore", keys, (key) => this.#local.removed.set(key, false));
  }

  /** Drops painted sizes: the stars get the sizes of the design's own profile again. */
  reset(keys) {
    this.#mark("reset", keys, (key) => (this.#local.sizes.delete(key), this.#local.reset.add(key)));
  }

  /** Weights of places in a fit: Map(key -> number, or null for none). */
  weigh(values) {
    for (const [key, value] of values) this.#local.weights.set(key, value);
    this.#gather("weigh", values, "weights");
  }

  /** Changes of the design file by dotted key; `local` is what to draw until the server answers. */
  design(changes, local = {}) {
    const { border } = changes;
    Object.assign(this.#local, border ? { border } : {}, local);
    this.#later("edit", { changes: { ...this.#waiting.get("edit")?.fields.changes, ...changes } });
  }

  /** A drawing that was sent before is laid on the sheet; the server says what comes of it. */
  drawing(fields) {
    this.#later("drawing", fields);
  }

  /** Sizes that the server will find by itself from the design's profile: drawn, not sent. Painted stars keep theirs. */
  preview(quantity, values) {
    const { key: field } = QUANTITIES[quantity];
    const { sites } = this.store.get("document").plan;
    const painted = new Set(sites.filter((entry) => entry.painted).map((entry) => entry.site.join()));
    for (const [key, value] of values) {
      if (!painted.has(key)) this.#local.sizes.set(key, { ...this.#local.sizes.get(key), [field]: value });
    }
    this.#draw();
  }

  /** A change that is complete at once: one gesture, one step of undo. */
  once(action) {
    this.begin();
    action(this);
    this.end();
  }

  end() {
    if (!this.isOpen) return;
    this.#flush(true);
    this.isOpen = false;
    this.#sent = this.#gesture;
  }

  /** Calls the open gesture off: nothing of it stays. */
  cancel() {
    if (!this.isOpen) return;
    this.#waiting.clear();
    this.#waiting.set("take back", { kind: "take back", fields: {} });
    this.#local = emptyLocal();
    this.end();
    this.#draw();
  }

  /** Takes over a document of the server; what is painted right now stays on top. */
  arrived(document) {
    const isCurrent = (document.gesture ?? 0) >= this.#sent || this.#arrived >= this.#sent;
    if (isCurrent) this.#arrived = this.#sent;
    if (!this.isOpen && isCurrent) this.#local = emptyLocal();
    this.store.set({ document, sheet: new Sheet(document, this.#local) }); // together: panels read both
    for (const message of this.#kept.splice(0)) this.connection.send(...message);
  }

  /** The connection is lost or there again. What was drawn without one is kept, and sent when the design is there. */
  reconnected() {
    if (!this.isOpen && !this.#kept.length) this.drop();
  }

  /** Forgets what was not accepted. */
  drop() {
    this.#waiting.clear();
    this.#kept.length = 0;
    clearTimeout(this.#timer);
    this.#timer = 0;
    this.#local = emptyLocal();
    this.isOpen = false;
    this.#arrived = this.#sent;
    this.#draw();
  }

  #mark(kind, keys, change) {
    keys.forEach(change);
    this.#gather(kind, new Map(keys.map((key) => [key, null])));
  }

  /** Values of stars, Map(key -> value), with those that wait; `name` is that of the values in the message. */
  #gather(kind, values, name = "") {
    const id = `${kind} ${name}`;
    const all = new Map([...(this.#waiting.get(id)?.values ?? []), ...values]);
    const sites = [...all.keys()].map((key) => key.split(",").map(Number));
    this.#later(kind, { sites, ...(name && { [name]: [...all.values()] }) }, id, all);
  }

  #later(kind, fields, id = kind, values = null) {
    this.#waiting.set(id, { kind, fields, values });
    if (!this.#timer) this.#timer = setTimeout(() => this.#flush(false), INTERVAL_MS);
    this.#draw();
  }

  #flush(isEnd) {
    clearTimeout(this.#timer);
    this.#timer = 0;
    let messages = [...this.#waiting.values()];
    this.#waiting.clear();
    if (isEnd && !messages.length) messages = [{ kind: "edit", fields: { changes: {} } }];
    messages.forEach(({ kind, fields }, k) => {
      const message = [kind, { gesture: this.#gesture, end: isEnd && k === messages.length - 1, ...fields }];
      if (this.#kept.length || !this.connection.send(...message)) this.#kept.push(message);
    });
  }

  #draw() {
    const document = this.store.get("document");
    if (document) this.store.set({ sheet: new Sheet(document, this.#local) });
  }
}
