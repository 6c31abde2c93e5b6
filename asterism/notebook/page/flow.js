// Requests of the sliders: one at a time is under way, and the newest of those that wait follows.

// an answer that takes longer is announced as late
const PATIENCE_MS = 1500;

export class Flow {
  #newest = null;
  #timer = 0;
  isLate = false;

  constructor(model) {
    this.model = model;
    this.sent = model.get("panel").answered;
    model.on("change:panel", () => this.#answered());
  }

  get isWaiting() {
    return this.model.get("panel").answered < this.sent;
  }

  /** Values of all sliders; `isDragging`: others will follow. `onLate` is called when an answer takes long. */
  ask(values, isDragging, onLate) {
    this.#newest = { values, is_dragging: isDragging };
    this.onLate = onLate;
    if (!this.isWaiting) this.#send();
  }

  #send() {
    const request = { seq: this.sent + 1, ...this.#newest };
    this.#newest = null;
    this.sent = request.seq;
    this.model.set("request", request);
    this.model.save_changes();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#tell(this.isWaiting), PATIENCE_MS);
  }

  #answered() {
    if (this.isWaiting) return;
    clearTimeout(this.#timer);
    this.#tell(false);
    if (this.#newest) this.#send();
  }

  #tell(isLate) {
    if (this.isLate === isLate) return;
    this.isLate = isLate;
    this.onLate?.();
  }
}
