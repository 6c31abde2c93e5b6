// The websocket: messages with numbers, binary frames with one acknowledgement each, and a reconnection that asks for everything again.

import { withoutOptions } from "./format.js";

const TYPES = { f4: Float32Array, u4: Uint32Array, i1: Int8Array, u1: Uint8Array };
const MAX_WAIT_MS = 5000;
const TRY_AGAIN_LATER = 1013; // too many pages are open

/** Header and arrays of a binary frame: kind, length of the header, header as JSON, arrays. */
export function unpack(buffer) {
  const [kind, length] = new Uint32Array(buffer, 0, 2);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const arrays = {};
  for (const { name, dtype, shape, offset: at } of header.arrays ?? []) {
    arrays[name] = new TYPES[dtype](buffer, at, shape.reduce((all, one) => all * one, 1));
    arrays[name].rows = shape[0];
  }
  return { kind, header, arrays };
}

/** Messages name no options of the command line. */
function plainWords(key, value) {
  if (key === "text" && typeof value === "string") return withoutOptions(value);
  return key === "warnings" && Array.isArray(value)
    ? value.map((one) => (typeof one === "string" ? withoutOptions(one) : one))
    : value;
}

export class Connection {
  #socket = null;
  #seq = 0;
  #wait = 250;
  #timer = 0;
  #isClosed = false;
  #failures = 0; // sockets in a row that did not open
  document = null; // number of the document that the page shows: the server refuses what is about another one

  /** `handlers`: message(object), frame({kind, header, arrays}), status("connecting" | "open" | "lost"), blocked(). */
  constructor(handlers) {
    this.handlers = handlers;
    this.open();
    addEventListener("pagehide", () => {
      this.#isClosed = true;
      this.#socket?.close();
    });
  }

  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  open() {
    clearTimeout(this.#timer);
    const url = new URL("live", location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    socket.onopen = () => {
      this.#wait = 250;
      this.#failures = -Infinity;
      this.handlers.status("open");
      this.send("hello");
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.handlers.message(JSON.parse(data, plainWords));
      else this.handlers.frame(unpack(data));
    };
    socket.onclose = ({ code }) => {
      if (code === TRY_AGAIN_LATER) this.#wait = MAX_WAIT_MS;
      if (this.#isClosed || socket !== this.#socket) return;
      this.#failures += 1;
      if (this.#failures === 3) fetch(location.href).then(() => this.handlers.blocked(), () => {});
      this.handlers.status("lost");
      this.#timer = setTimeout(() => this.open(), this.#wait);
      this.#wait = Math.min(2 * this.#wait, MAX_WAIT_MS);
    };
  }

  /** Sends a message and returns its number, or 0 if there is no connection. */
  send(type, fields = {}) {
    if (!this.isOpen) return 0;
    this.#seq += 1;
    this.#socket.send(JSON.stringify({ type, seq: this.#seq, document: this.document, ...fields }));
    return this.#seq;
  }

  acknowledge(frame) {
    if (this.isOpen) this.#socket.send(JSON.stringify({ type: "ack", frame }));
  }
}
