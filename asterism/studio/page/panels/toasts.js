// Short messages above the status line and the notes. Refused edits name the field and the place.

import { button, h } from "../dom.js";
import { icon } from "../icons.js";

const STAY_MS = 9000;
const GAP_PX = 8;

export function toast(text, { isBad = false, action = null, other = null, stay = STAY_MS } = {}) {
  const list = document.getElementById("toasts");
  [...list.children].find((one) => one.dataset.text === text)?.remove();
  const offers = [action, other].filter(Boolean);
  const element = h(isBad ? "div.toast.bad" : "div.toast", { testid: isBad ? "problem" : "toast", "data-text": text }, [
    icon(isBad ? "warn" : "info"),
    h("div.grow", text),
    offers.map((one) => button({ text: one.text, onclick: () => (one.run(), element.remove()) })),
    button({ icon: "close", label: "Dismiss", kind: "plain", onclick: () => element.remove() }),
  ]);
  list.append(element);
  while (list.children.length > 3) list.firstChild.remove();
  if (stay) setTimeout(() => element.remove(), stay);
}

/** Keeps messages above notes and buttons at the bottom of the page, whose height follows their text. */
export function keepToastsAbove(...elements) {
  const list = document.getElementById("toasts");
  const observer = new ResizeObserver(() => {
    const boxes = elements.map((element) => element.getBoundingClientRect()).filter(({ height }) => height);
    list.style.bottom = boxes.length ? `${GAP_PX + innerHeight - Math.min(...boxes.map(({ top }) => top))}px` : "";
  });
  elements.forEach((element) => observer.observe(element));
}

export function announce(text) {
  document.getElementById("announce").textContent = text;
}
