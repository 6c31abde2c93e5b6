// The table of stars: everything of the plan as text and number fields.

import { check, dialog, h, table } from "./dom.js";
import { QUANTITIES, fixed } from "./format.js";
import { numberCell } from "./panels/fields.js";
import { rebuild } from "./rebuild.js";

const MAX_ROWS = 400;

export function openTable({ store, edits }) {
  const body = h("tbody", {});
  const note = h("p", { class: "hint" });
  let isSelectionOnly = false;
  const filter = check({
    text: "Only selected stars",
    value: false,
    testid: "table-filter",
    onchange: (value) => ((isSelectionOnly = value), fill()),
  });

  function cell(star, quantity) {
    const { key, name, column } = QUANTITIES[quantity];
    const input = numberCell({
      value: String(Number(star.sizes[column].toFixed(3))),
      label: `${name} of star ${star.row} in mm`,
      testid: `star-${star.row}-${quantity}`,
      limits: () => store.get("sheet").range(quantity, false),
      onchange: (value) => edits.once(() => edits.sizes(quantity, new Map([[star.key, value]]))),
    });
    input.disabled = star.removed;
    input.dataset.field = `stars.${key}`;
    return h("td", {}, input);
  }

  function row(star) {
    const tick = (label, testid, checked, onchange) => {
      const box = h("input", { type: "checkbox", checked, "aria-label": `${label} star ${star.row}`, testid });
      box.addEventListener("change", () => onchange(box.checked));
      return h("td", {}, box);
    };
    const isSelected = store.get("selection").has(star.key);
    const select = (isChosen) => {
      const selection = new Set(store.get("selection"));
      selection[isChosen ? "add" : "delete"](star.key);
      store.set({ selection });
    };
    const print = (isPrinted) => edits.once(() => edits[isPrinted ? "restore" : "remove"]([star.key]));
    return h(
      "tr",
      { "aria-selected": String(isSelected) },
      tick("Select", `select-${star.row}`, isSelected, select),
      h("td", {}, star.row),
      h("td", {}, `${star.site[0]}, ${star.site[1]}`),
      h("td", {}, fixed(star.at[0])),
      h("td", {}, fixed(star.at[1])),
      Object.keys(QUANTITIES).map((quantity) => cell(star, quantity)),
      tick("Print", `print-${star.row}`, !star.removed, print),
    );
  }

  function fill() {
    const all = store.get("sheet")?.stars ?? [];
    const shown = isSelectionOnly ? all.filter((star) => store.get("selection").has(star.key)) : all;
    note.textContent =
      shown.length > MAX_ROWS
        ? `The first ${MAX_ROWS} of ${shown.length} stars. Select some in the plan to see the others.`
        : `${shown.length} stars. Sizes in mm.`;
    rebuild(body, () => shown.slice(0, MAX_ROWS).map(row));
  }

  const heads = ["", "Star", "Site", "x, mm", "y, mm", "Length", "Thickness", "Width", "Printed"];
  const stop = store.on(["sheet", "selection"], fill);
  dialog(
    "Stars",
    [
      h("div", { class: "row" }, h("span", { class: "grow" }, note), filter.element),
      table({ class: "small", testid: "star-table" }, heads, body),
    ],
    { testid: "table-dialog", onclose: stop },
  );
  fill();
}
