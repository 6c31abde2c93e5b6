// The panel on the right: pages for the tool, the sheet's material, and the shape.

import { h, replace } from "../dom.js";
import { plainField } from "../format.js";

const PAGES = { tool: "Tool", sheet: "Material", shape: "Shape" };

/** `panels`: what builds a page; that of a tool is its own. Each returns elements, and is told of changes by `on`. */
export function buildInspector(element, studio, panels) {
  const { store, tools } = studio;
  const tabs = Object.keys(PAGES).map((page) =>
    h("button", {
      type: "button",
      class: "tab",
      role: "tab",
      id: `tab-${page}`,
      "aria-controls": "page",
      testid: `tab-${page}`,
      onclick: () => store.set({ page }),
    }),
  );
  const list = h("div", { class: "tabs", role: "tablist", "aria-label": "Inspector" }, tabs);
  list.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const at = (tabs.indexOf(document.activeElement) + step + tabs.length) % tabs.length;
    tabs[at].focus();
    tabs[at].click();
  });
  const body = h("div", { class: "pages", id: "page", role: "tabpanel", tabindex: "-1" });
  element.append(list, body);
  let stop = [];
  let shown = "";

  function build() {
    const page = store.get("page");
    const tool = store.get("tool");
    const wanted = page === "tool" ? `tool ${tool}` : page;
    if (wanted === shown) return;
    shown = wanted;
    stop.forEach((end) => end());
    stop = [];
    const panel = page === "tool" ? tools[tool].panel : panels[page];
    const on = (keys, listener) => stop.push(store.on(keys, listener));
    replace(body, panel(studio, { on }));
    body.setAttribute("aria-labelledby", `tab-${page}`);
    body.scrollTop = 0;
    showFault();
  }
  /** What stands in the way of a shape, beside the control of the value that it is about. */
  function showFault() {
    const { problem } = store.get("state");
    for (const element of body.querySelectorAll("[data-field]")) {
      const line = element.querySelector(":scope > .fault");
      const isAbout = Boolean(problem?.field) && element.dataset.field === plainField(problem.field);
      if (!line || (!isAbout && !element.dataset.blocked)) continue;
      element.classList.toggle("bad", isAbout);
      line.hidden = !isAbout;
      line.textContent = isAbout ? problem.text : "";
      if (isAbout) element.dataset.blocked = "true";
      else delete element.dataset.blocked;
    }
  }
  function mark() {
    const page = store.get("page");
    const count = store.get("state").warnings?.length ?? 0;
    tabs.forEach((tab, k) => {
      const name = Object.keys(PAGES)[k];
      tab.setAttribute("aria-selected", String(name === page));
      tab.tabIndex = name === page ? 0 : -1;
      const title = name === "tool" ? tools[store.get("tool")].title : PAGES[name];
      const badge = name === "shape" && count > 0 && h("span", { class: "badge", title: `${count} warnings` }, count);
      replace(tab, title, badge);
    });
  }
  store.on(["page", "tool"], () => (build(), mark()));
  store.on(["state"], () => (mark(), showFault()));
  build();
  mark();
}
