// The panel on the right: pages for the tool, the sheet's material, and the shape.

import { h, nextByArrow, replace } from "../dom.js";
import { plainField } from "../format.js";
import { showFault } from "./fields.js";

const PAGES = { tool: "Tool", sheet: "Material", shape: "Shape" };

/** `panels`: what builds a page; that of a tool is its own. Each returns elements, and is told of changes by `on`. */
export function buildInspector(element, studio, panels) {
  const { store, tools } = studio;
  const tabs = Object.keys(PAGES).map((page) =>
    h("button.tab", {
      type: "button",
      role: "tab",
      id: `tab-${page}`,
      "aria-controls": "page",
      testid: `tab-${page}`,
      onclick: () => store.set({ page }),
    }),
  );
  const onkeydown = (event) => nextByArrow(event, tabs)?.click();
  const list = h("div.tabs", { role: "tablist", "aria-label": "Inspector", onkeydown }, tabs);
  const body = h("div.pages", { id: "page", role: "tabpanel", tabindex: "-1" });
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
    showProblem();
  }
  /** What stands in the way of a shape, beside the control of the value that it is about. */
  function showProblem() {
    const { problem } = store.get("state");
    for (const one of body.querySelectorAll("[data-field]")) {
      const line = one.querySelector(":scope > .fault");
      const isAbout = Boolean(problem?.field) && one.dataset.field === plainField(problem.field);
      if (!line || (!isAbout && !one.dataset.blocked)) continue;
      showFault(line, isAbout ? problem.text : null, one, "bad");
      if (isAbout) one.dataset.blocked = "true";
      else delete one.dataset.blocked;
    }
  }
  function mark() {
    const count = store.get("state").warnings?.length ?? 0;
    Object.entries(PAGES).forEach(([name, title], k) => {
      const isShown = name === store.get("page");
      tabs[k].setAttribute("aria-selected", String(isShown));
      tabs[k].tabIndex = isShown ? 0 : -1;
      const badge = name === "shape" && count > 0 && h("span.badge", { title: `${count} warnings` }, count);
      replace(tabs[k], name === "tool" ? tools[store.get("tool")].title : title, badge);
    });
  }
  store.on(["page", "tool"], () => (build(), mark()));
  store.on(["state"], () => (mark(), showProblem()));
  build();
  mark();
}
