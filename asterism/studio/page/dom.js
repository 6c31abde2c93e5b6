// Small helpers to make elements. Styles are set through classes and CSSOM only, as the content policy demands.

import { icon } from "./icons.js";

const LIVE = Symbol("live"); // of an element: what shows it, and all in it, as things are now
const isProps = (value) => value && Object.getPrototypeOf(value) === Object.prototype && !value.element;

/**
 * An element: `h("div.row", { onclick }, child, "text")`, with classes after the name of its tag. Children are
 * elements, controls with an `element`, texts, and lists of these. Keys with a dash become attributes. A property, or
 * the text, may be a function: what it returns then is put there by `show`.
 */
export function h(tag, ...children) {
  const [name, ...classes] = tag.split(".");
  const element = document.createElement(name);
  if (classes.length) element.className = classes.join(" ");
  for (const [key, value] of Object.entries(isProps(children[0]) ? children.shift() : {})) {
    if (value === undefined || value === null) continue;
    if (key === "testid") element.dataset.testid = value;
    else if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (typeof value === "function") live(element, changed(value, (now) => put(element, key, now)));
    else put(element, key, value);
  }
  append(element, children);
  return element;
}

/** Has `use` called with what `ask` returns, when that is another value than before. */
function changed(ask, use) {
  let last;
  return () => {
    const now = ask();
    if (now !== last) use(now);
    last = now;
  };
}

function put(element, key, value) {
  if (key in element && !key.includes("-") && key !== "list") element[key] = value;
  else if (value === null || value === undefined || value === false) element.removeAttribute(key);
  else element.setAttribute(key, value === true ? "" : String(value));
}

/** Children that stay: what shows them belongs to what shows the element. */
export function append(element, children) {
  for (const child of listOf(children)) {
    if (typeof child === "function") live(element, changed(child, (text) => (element.textContent = text)));
    else element.append(child);
    if (child[LIVE]) (element[LIVE] ??= []).push(...child[LIVE]);
  }
}

/** The elements, texts and functions among children. */
const listOf = (children) =>
  children
    .flat(Infinity)
    .map((child) => child?.element ?? child)
    .filter((child) => child !== null && child !== undefined && child !== false);

/** Has a function called now, and whenever the element, or one that it is a part of, is shown. */
export function live(element, show) {
  (element[LIVE] ??= []).push(show);
  show();
}

/** Shows elements and controls as things are now. */
export const show = (...items) =>
  items.flat(Infinity).forEach((one) => (one?.element ?? one)?.[LIVE]?.forEach((each) => each()));

/** Shows them at each change of the keys, too, and returns them. `on`: of the store, or of their page. */
export function follow(on, keys, ...items) {
  on(keys, () => show(items));
  return items;
}

/** Content that `build` makes, anew when what it shows has changed: `content`, as JSON. */
export function part(testid, content, build) {
  const element = h("div", { testid });
  live(element, () => {
    const known = content();
    refresh(element, known, () => build(known));
  });
  return element;
}

/** Value and change of a control that is about an entry of the store, or about a key of such an entry. */
export const bound = (store, entry, key = null) => ({
  value: () => (key ? store.get(entry)[key] : store.get(entry)),
  onchange: (value) => store.set({ [entry]: key ? { ...store.get(entry), [key]: value } : value }),
});

/** Other children, which stay as they are until they are replaced. */
export const replace = (element, ...children) => element.replaceChildren(...listOf(children));

const drawn = new WeakMap();

/** Replaces the content only if what it shows has changed: a button must not vanish under the pointer. */
export function refresh(element, content, build) {
  const text = JSON.stringify(content);
  if (drawn.get(element) === text) return;
  drawn.set(element, text);
  replace(element, build());
}

export const DARK = "(prefers-color-scheme: dark)";
/** Whether dark colours are used. */
export const isDark = (element = document.documentElement) => getComputedStyle(element).colorScheme.trim() === "dark";

/** A button with text, an icon, or both. `label` is its accessible name, `keys` the shortcut shown in the tooltip. */
export function button({ text, icon: name, label, keys, kind = "", pressed, ...rest }) {
  const now = (value) => (typeof value === "function" ? value() : value);
  const said = () => label ?? now(text);
  const props = {
    type: "button",
    title: () => [said(), keys && `(${keys})`].filter(Boolean).join(" "),
    "aria-label": said,
    "aria-pressed": pressed === undefined ? undefined : () => String(now(pressed)),
    "aria-keyshortcuts": keys,
    ...rest,
  };
  const classes = ["button", ...kind.split(" ").filter(Boolean), ...(text ? [] : ["icon"])].join(".");
  return h(`button.${classes}`, props, name && icon(name), text && h("span", text));
}

/** A button as wide as its panel. */
export const wide = (text, testid, onclick, rest = {}) => button({ text, kind: "wide", testid, onclick, ...rest });

/** Options of a list: texts, or what an option has besides its value, by value; or a list of options. */
const listed = (options) =>
  Array.isArray(options)
    ? options
    : Object.entries(options).map(([value, one]) => (typeof one === "string" ? { value, text: one } : { ...one, value }));

/** The element of a control of one value, and `set`; a function for the value is asked by `show`. */
function control(element, value, set) {
  if (typeof value === "function") live(element, () => set(value()));
  else set(value);
  return { element, set };
}

/** 1 and −1 for the keys + and −, which make things larger and smaller. */
export const signOf = ({ key }) => ({ "+": 1, "=": 1, "-": -1 })[key];
export const isDelete = ({ key }) => key === "Delete" || key === "Backspace";

/** What the arrow keys do in a direction of the plan, x to the right and y upwards. */
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Focuses the next one of some buttons at an arrow key; returns it. */
export function nextByArrow(event, buttons) {
  const [right, up] = ARROWS[event.key] ?? [0, 0];
  const step = right - up;
  if (!step) return null;
  event.preventDefault();
  event.stopPropagation();
  const next = buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length];
  next.focus();
  return next;
}

/** One of several values, as a row of buttons with arrow keys. Returns {element, set}. */
export function segments({ label, options: choices, value, onchange, testid, hidden }) {
  const options = listed(choices);
  const buttons = options.map(({ value: one, text, title = text, hidden: isLeftOut }) => {
    const props = { type: "button", role: "radio", title, "aria-label": title, testid: testid && `${testid}-${one}` };
    return h("button", { ...props, hidden: isLeftOut, onclick: () => (set(one), onchange(one)) }, text);
  });
  const shown = () => buttons.filter((button) => !button.hidden);
  const onkeydown = (event) => nextByArrow(event, shown())?.click();
  const element = h("div.segments", { role: "radiogroup", "aria-label": label, testid, hidden, onkeydown }, buttons);
  function set(chosen) {
    const isKnown = options.some((option) => option.value === chosen);
    options.forEach(({ value: one }, k) => {
      buttons[k].setAttribute("aria-checked", String(one === chosen));
      buttons[k].tabIndex = one === chosen || (!isKnown && k === 0) ? 0 : -1;
    });
  }
  return control(element, value, set);
}

/** A drop-down list; its options may follow the state, too. Returns {element, set}. */
export function choice({ label, options, value, onchange, ...rest }) {
  const change = () => onchange(element.value);
  const element = h("select", { "aria-label": label, title: label, onchange: change, ...rest });
  const item = ({ value: one, disabled, text }) => h("option", { value: one, disabled }, text);
  const list = () => listed(typeof options === "function" ? options() : options);
  live(element, () => refresh(element, list(), () => list().map(item)));
  return control(element, value, (chosen) => (element.value = chosen));
}

/** A check box with its text. Returns {element, set, box}. */
export function check({ text, value, onchange, testid, hidden }) {
  const box = h("input", { type: "checkbox", testid, onchange: () => onchange?.(box.checked) });
  return { ...control(h("label.check", { hidden }, box, h("span", text)), value, (on) => (box.checked = on)), box };
}

export const section = (title, ...extra) => h("h2.section", h("span", title), extra);

/** The title of a section of so many things. */
export const counted = (title, count, ...extra) => section(title, h("span.count", String(count)), ...extra);

/** A control beside its name. */
export const labelled = (name, one) => h("div.field", h("label", name), one);

/** Names with their values, [name, value] each. */
export const figures = (rows, testid) =>
  h("dl.figures", { testid }, rows.map(([name, value]) => [h("dt", name), h("dd", value)]));

/** A table under its heads; `body` is its tbody or the rows of one. */
export const table = (props, heads, body) =>
  h("table.small", props, [
    h("thead", h("tr", heads.map((text) => h("th", { scope: "col" }, text)))),
    Array.isArray(body) ? h("tbody", body) : body,
  ]);

/** An item of a list that does something, or is chosen. */
export function listItem({ icon: name, text, count, kind = "", isCurrent, ...rest }) {
  const props = { type: "button", "aria-current": isCurrent === undefined ? undefined : String(isCurrent), ...rest };
  const said = [h("span.grow", text), count === undefined ? null : h("span.count", count)];
  return h("li", h(`button.item${kind && `.${kind}`}`, props, icon(name), said));
}

/** Address of a file of the server's folder. */
export const addressOf = (name) => `file/${encodeURI(name)}`;

/** A button that opens a file of the server's folder. */
export const fileLink = (name, picture, text) =>
  h("a.button", { href: addressOf(name), target: "_blank", rel: "noopener" }, icon(picture), text);

/** A list of warnings; null if there are none. */
export function warningList(texts) {
  if (!texts.length) return null;
  return h("ul.list", texts.map((text) => h("li.item.warn", icon("warn"), h("span.grow", text))));
}

export const hint = (text, props = {}) => h("p.hint", props, text);

/** A modal dialog with a title; removed from the page when it closes. */
export function dialog(title, body, { testid, onclose } = {}) {
  const close = button({ icon: "close", label: "Close", kind: "plain", onclick: () => element.close() });
  const element = h("dialog", { "aria-label": title, testid, onclose: () => (element.remove(), onclose?.()) }, [
    h("div.dialog-head", h("h1", title), close),
    h("div.dialog-body", body),
  ]);
  element.addEventListener("click", (event) => event.target === element && element.close());
  document.body.append(element);
  element.showModal();
  return element;
}

/** A colour of the theme, by its name in the style sheets. */
export const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
