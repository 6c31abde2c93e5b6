// Part of the shape's panel: how much prints of the design differ from its exact shape.

import { button, h, hint, refresh, section, warningList } from "../dom.js";
import { capital } from "../format.js";
import { icon } from "../icons.js";

export function spreadPart({ store, connection }, { on }) {
  const part = h("div", { testid: "spread" });

  function update() {
    const { spread: result } = store.get("results");
    const isRunning = Boolean(store.get("jobs").spread);
    const isExact = store.get("badge").kind === "exact";
    const isOld = result?.revision !== store.get("document")?.revision;
    refresh(part, [result, isOld, isRunning, isExact], () => [
      section("How much prints differ"),
      ...(isRunning ? [hint("Under way: see the line at the bottom.")] : found(result, isOld, isExact)),
    ]);
  }

  /** The range, and the button that computes it. */
  function found(result, isOld, isExact) {
    const has = Boolean(result?.summary);
    const start = button({
      text: has ? "Compute again" : "Range of prints",
      kind: has ? "" : "wide",
      testid: "spread-go",
      disabled: !isExact,
      onclick: () => connection.send("spread"),
    });
    if (!has) return [hint("Ten exact shapes tell what nobody knows exactly, such as the stretch, is worth."), start];
    const [file] = result.files;
    return [
      isOld ? hint("The design has changed since.") : null,
      h(
        "div",
        { testid: "spread-found" },
        Object.entries(result.summary.rows).map(([name, text]) => h("p", {}, h("b", {}, `${capital(name)}: `), text)),
      ),
      h(
        "div",
        { class: "row wrap" },
        file &&
          h(
            "a",
            { class: "button", href: `file/${encodeURI(file.name)}`, target: "_blank", rel: "noopener" },
            icon("camera"),
            "Picture",
          ),
        start,
      ),
      warningList(result.warnings.map(capital)),
    ];
  }

  on(["jobs", "results", "document", "badge"], update);
  update();
  return part;
}
