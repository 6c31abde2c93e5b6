// Panel of the selection: exact sizes, ring, same size, remove and restore.

import { button, h, hint, section, segments } from "../dom.js";
import { QUANTITIES, plural } from "../format.js";
import { ringKeys, sameSizeKeys } from "../plan/tools/select.js";
import { numberField } from "./fields.js";

export function selectionPanel({ store, edits, actions }, { on }) {
  const title = section("No star selected");
  const empty = hint(
    "Click a star in the plan or on the sheet. Drag a lasso to take several, double-click to take its ring.",
  );
  const stars = () => [...store.get("selection")].map((key) => store.get("sheet")?.byKey.get(key)).filter(Boolean);
  const fields = Object.entries(QUANTITIES).map(([quantity, { name, key, step }]) =>
    numberField({
      label: name,
      value: null,
      step,
      digits: 3,
      testid: `selected-${quantity}`,
      field: `stars.${key}`,
      onchange: (value) => edits.once(() => edits.sizes(quantity, new Map(stars().map((star) => [star.key, value])))),
    }),
  );
  const act = (text, run, testid) => button({ text, testid, onclick: run });
  const select = (keys) => store.set({ selection: new Set(keys) });
  const sheet = () => store.get("sheet");
  const wanted = (holds) => () => select(sheet().stars.filter(holds).map((star) => star.key));
  const grow = h(
    "div",
    { class: "row wrap" },
    act("All", actions.selectAll, "select-all"),
    act("Ring", () => select(stars().flatMap((star) => ringKeys(sheet(), star))), "select-ring"),
    act("Same size", () => select(sameSizeKeys(sheet(), store.get("selection"))), "select-same"),
    act("Invert", wanted((star) => !store.get("selection").has(star.key)), "select-invert"),
    act("Painted", wanted((star) => star.painted), "select-painted"),
  );
  const selecting = segments({
    label: "What a click or a lasso does",
    testid: "selecting",
    options: {
      new: "New",
      more: { text: "Add", title: "Add (Shift)" },
      less: { text: "Take away", title: "Take away (Alt)" },
    },
    value: store.get("selecting"),
    onchange: (value) => store.set({ selecting: value }),
  });
  const keys = () => stars().map((star) => star.key);
  const paste = button({ text: "Paste sizes", keys: "Ctrl+V", testid: "paste-sizes", onclick: actions.pasteSizes });
  const change = h(
    "div",
    { class: "row wrap" },
    button({ icon: "trash", text: "Remove", keys: "Delete", testid: "remove", onclick: actions.removeSelected }),
    act("Restore", () => edits.once(() => edits.restore(keys())), "restore"),
    act("Back to the profile", () => edits.once(() => edits.reset(keys())), "reset"),
    button({ text: "Copy sizes", keys: "Ctrl+C", testid: "copy-sizes", onclick: actions.copySizes }),
    paste,
  );
  const chosen = h("div", {}, fields.map((one) => one.element), change);
  function update() {
    const all = stars();
    title.firstChild.textContent = all.length ? `${plural(all.length, "star")} selected` : "No star selected";
    empty.hidden = all.length > 0;
    chosen.hidden = all.length === 0;
    paste.disabled = !store.get("copied");
    for (const id of ["select-ring", "select-same"])
      grow.querySelector(`[data-testid="${id}"]`).disabled = all.length === 0;
    Object.entries(QUANTITIES).forEach(([quantity, { column }], k) => {
      const values = all.map((star) => star.sizes[column]);
      const isSame = values.every((value) => Math.abs(value - values[0]) < 1e-6);
      fields[k].limits(...(sheet()?.range(quantity, false) ?? [0, 100]));
      fields[k].set(isSame && values.length ? values[0] : null);
      fields[k].input.placeholder =
        isSame || !values.length ? "" : `${Math.min(...values).toFixed(1)}–${Math.max(...values).toFixed(1)}`;
    });
  }
  on(["selection", "sheet", "copied"], update);
  update();
  on(["selecting"], ({ selecting: way }) => selecting.set(way));
  return [selecting.element, title, empty, chosen, section("Extend"), grow];
}
