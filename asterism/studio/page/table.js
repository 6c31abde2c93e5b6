// The table of stars: everything of the plan as text and number fields.

import { check, dialog, h, table } from "./dom.js";
import { QUANTITIES, QUANTITY_NAMES, fixed, plural } from "./format.js";
import { numberCell, rebuild } from "./panels/fields.js";

const MAX_ROWS = 400;

export function openTable({ store, edits }) {
  const body = h("tbody");
  const note = h("p.hint");
  let isSelectionOnly = false;
  const filter = check({
    text: "Only selected stars",
    value: false,
    testid: "table-filter",
    onchange: (value) => ((isSelectionOnly = value), fill()),
  });

  function cell(star, quantity) {
    const { key, name, column } = QUANTITIES[quantity];
    return h("td", [
      numberCell({
        value: String(Number(star.sizes[column].toFixed(3))),
        "aria-label": `${name} of star ${star.row} in mm`,
        testid: `star-${star.row}-${quantity}`,
        "data-field": `stars.${key}`,
        disabled: star.removed,
        limits: () => store.get("sheet").range(quantity, false),
        onchange: (value) => edits.once(() => edits.sizes(quantity, new Map([[star.key, value]]))),
      }),
    ]);
  }

  function row(star) {
    const tick = (label, checked, onchange) => {
      const testid = `${label.toLowerCase()}-${star.row}`;
      const props = { type: "checkbox", checked, "aria-label": `${label} star ${star.row}`, testid };
      return h("td", h("input", { ...props, onchange: ({ target }) => onchange(target.checked) }));
    };
    const isSelected = store.get("selection").has(star.key);
    const select = (isChosen) => {
      const selection = new Set(store.get("selection"));
      selection[isChosen ? "add" : "delete"](star.key);
      store.set({ selection });
    };
    const print = (isPrinted) => edits.once(() => edits[isPrinted ? "restore" : "remove"]([star.key]));
    return h("tr", { "aria-selected": String(isSelected) }, [
      tick("Select", isSelected, select),
      [star.row, star.site.join(", "), fixed(star.at[0]), fixed(star.at[1])].map((said) => h("td", String(said))),
      Object.keys(QUANTITIES).map((quantity) => cell(star, quantity)),
      tick("Print", !star.removed, print),
    ]);
  }

  function fill() {
    const all = store.get("sheet")?.stars ?? [];
    const shown = isSelectionOnly ? all.filter((star) => store.get("selection").has(star.key)) : all;
    note.textContent =
      shown.length > MAX_ROWS
        ? `The first ${MAX_ROWS} of ${shown.length} stars. Select some in the plan to see the others.`
        : `${plural(shown.length, "star")}. Sizes in mm.`;
    rebuild(body, () => shown.slice(0, MAX_ROWS).map(row));
  }

  const heads = ["", "Star", "Site", "x, mm", "y, mm", ...Object.values(QUANTITY_NAMES), "Printed"];
  const stop = store.on(["sheet", "selection"], fill);
  dialog(
    "Stars",
    [h("div.row", h("span.grow", note), filter), table({ testid: "star-table" }, heads, body)],
    { testid: "table-dialog", onclose: stop },
  );
  fill();
}
