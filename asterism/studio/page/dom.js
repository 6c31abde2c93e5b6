// Small helpers to make elements. Styles are set through classes and CSSOM only, as the content policy demands.

import { icon } from "./icons.js";

/** An element: `h("div", { class: "row", onclick }, child, "text")`. Keys with a dash become attributes. */
export function h(tag, props = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key === "class") element.className = value;
    else if (key === "id") element.id = value;
    else if (key === "testid") element.dataset.testid = value;
    else if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key in element && !key.includes("-") && key !== "list") element[key] = value;
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

function append(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
}

export function replace(element, ...children) {
  element.replaceChildren();
  append(element, children);
}

const drawn = new WeakMap();

/** Replaces the content only if what it shows has changed: a button must not vanish under the pointer. */
export function refresh(element, content, build) {
  const text = JSON.stringify(content);
  if (drawn.get(element) === text) return;
  drawn.set(element, text);
  replace(element, build());
}

/** A button with text, an icon, or both. `label` is its accessible name, `keys` the shortcut shown in the tooltip. */
export function button({ text, icon: name, label, keys, kind = "", testid, onclick, pressed, disabled }) {
  const title = [label ?? text, keys && `(${keys})`].filter(Boolean).join(" ");
  return h(
    "button",
    {
      type: "button",
      class: `button ${kind} ${text ? "" : "icon"}`,
      title,
      "aria-label": label ?? text,
      "aria-pressed": pressed === undefined ? undefined : String(pressed),
      "aria-keyshortcuts": keys,
      testid,
      onclick,
      disabled,
    },
    name ? icon(name) : null,
    text ? h("span", {}, text) : null,
  );
}

/** Options of a list: texts, or what an option has besides its value, by value; or a list of options. */
const listed = (options) =>
  Array.isArray(options)
    ? options
    : Object.entries(options).map(([value, one]) => (typeof one === "string" ? { value, text: one } : { ...one, value }));

/** One of several values, as a row of buttons with arrow keys. Returns {element, set}. */
export function segments({ label, options: choices, value, onchange, testid }) {
  const options = listed(choices);
  const buttons = options.map((option) =>
    h(
      "button",
      {
        type: "button",
        role: "radio",
        title: option.title ?? option.text,
        "aria-label": option.title ?? option.text,
        testid: testid ? `${testid}-${option.value}` : undefined,
        onclick: () => choose(option.value),
      },
      option.icon ? icon(option.icon) : option.text,
    ),
  );
  const element = h("div", { class: "segments", role: "radiogroup", "aria-label": label, testid }, buttons);
  element.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const at = buttons.indexOf(document.activeElement);
    const next = (at + step + buttons.length) % buttons.length;
    buttons[next].focus();
    choose(options[next].value);
  });
  function set(chosen) {
    options.forEach((option, k) => {
      buttons[k].setAttribute("aria-checked", String(option.value === chosen));
      buttons[k].tabIndex = option.value === chosen ? 0 : -1;
    });
    if (!options.some((option) => option.value === chosen)) buttons[0].tabIndex = 0;
  }
  function choose(chosen) {
    set(chosen);
    onchange(chosen);
  }
  set(value);
  return { element, set };
}

/** A drop-down list. Returns {element, set}. */
export function choice({ label, options, value, onchange, testid }) {
  const element = h(
    "select",
    { "aria-label": label, title: label, testid, onchange: () => onchange(element.value) },
    listed(options).map((option) => h("option", { value: option.value, disabled: option.disabled }, option.text)),
  );
  element.value = value;
  return { element, set: (chosen) => (element.value = chosen) };
}

/** A check box with its text. Returns {element, set}. */
export function check({ text, value, onchange, testid, disabled, title }) {
  const box = h("input", { type: "checkbox", checked: value, disabled, testid, onchange: () => onchange?.(box.checked) });
  return { element: h("label", { class: "check", title }, box, text), set: (on) => (box.checked = on), box };
}

export function section(title, ...extra) {
  return h("h2", { class: "section" }, h("span", {}, title), extra);
}

/** The title of a section of so many things. */
export const counted = (title, count, ...extra) => section(title, h("span", { class: "count" }, String(count)), ...extra);

/** A control beside its name. */
export const labelled = (name, { element }) => h("div", { class: "field" }, h("label", {}, name), element);

/** Names with their values, [name, value] each; the rows alone for a list that stays. */
export const figureRows = (rows) => rows.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]);
export const figures = (rows, testid) => h("dl", { class: "figures", testid }, figureRows(rows));

/** A table under its heads; `body` is its tbody or the rows of one. */
export const table = (props, heads, body) =>
  h(
    "table",
    props,
    h("thead", {}, h("tr", {}, heads.map((text) => h("th", { scope: "col" }, text)))),
    Array.isArray(body) ? h("tbody", {}, body) : body,
  );

/** An item of a list that does something, or is chosen. */
export function listItem({ icon: name, text, count, kind = "", isCurrent, testid, onclick }) {
  const current = isCurrent === undefined ? undefined : String(isCurrent);
  return h(
    "li",
    {},
    h(
      "button",
      { type: "button", class: `item ${kind}`, "aria-current": current, testid, onclick },
      icon(name),
      h("span", { class: "grow" }, text),
      count === undefined ? null : h("span", { class: "count" }, count),
    ),
  );
}

/** A button that opens a file of the server's folder. */
export const fileLink = (name, picture, text) =>
  h(
    "a",
    { class: "button", href: `file/${encodeURI(name)}`, target: "_blank", rel: "noopener" },
    icon(picture),
    text,
  );

/** A list of warnings; null if there are none. */
export function warningList(texts) {
  if (!texts.length) return null;
  const item = (text) => h("li", { class: "item warn" }, icon("warn"), h("span", { class: "grow" }, text));
  return h("ul", { class: "list" }, texts.map(item));
}

export function hint(text) {
  return h("p", { class: "hint" }, text);
}

/** A modal dialog with a title; removed from the page when it closes. */
export function dialog(title, body, { testid, onclose } = {}) {
  const element = h(
    "dialog",
    { "aria-label": title, testid, onclose: () => (element.remove(), onclose?.()) },
    h(
      "div",
      { class: "dialog-head" },
      h("h1", {}, title),
      button({ icon: "close", label: "Close", kind: "plain", onclick: () => element.close() }),
    ),
    h("div", { class: "dialog-body" }, body),
  );
  element.addEventListener("click", (event) => {
    if (event.target === element) element.close();
  });
  document.body.append(element);
  element.showModal();
  return element;
}
