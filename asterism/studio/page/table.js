// The table of stars: everything of the plan as text and number fields.

import { check, dialog, h } from "./dom.js";
import { QUANTITIES, fixed, mistakeOf, numberOf } from "./format.js";
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
    const input = h("input", {
      class: "text cell",
      value: String(Number(star.sizes[column].toFixed(3))),
      disabled: star.removed,
      "aria-label": `${name} of star ${star.row} in mm`,
      testid: `star-${star.row}-${quantity}`,
    });
    input.dataset.field = `stars.${key}`;
    input.addEventListener("keydown", (event) => event.stopPropagation());
    input.addEventListener("change", () => {
      const limits = store.get("sheet").range(quantity, false);
      const refused = mistakeOf(input.value, { unit: "mm", limits });
      input.classList.toggle("bad-field", Boolean(refused));
      input.setAttribute("aria-invalid", String(Boolean(refused)));
      input.title = refused ?? "";
      if (!refused) edits.once(() => edits.sizes(quantity, new Map([[star.key, numberOf(input.value, "mm")]])));
    });
    return h("td", {}, input);
  }

  function row(star) {
    const selected = h("input", {
      type: "checkbox",
      checked: store.get("selection").has(star.key),
      "aria-label": `Select star ${star.row}`,
      testid: `select-${star.row}`,
    });
    selected.addEventListener("change", () => {
      const selection = new Set(store.get("selection"));
      if (selected.checked) selection.add(star.key);
      else selection.delete(star.key);
      store.set({ selection });
    });
    const printed = h("input", {
      type: "checkbox",
      checked: !star.removed,
      "aria-label": `Print star ${star.row}`,
      testid: `print-${star.row}`,
    });
    printed.addEventListener("change", () =>
      edits.once(() => (printed.checked ? edits.restore([star.key]) : edits.remove([star.key]))),
    );
    return h(
      "tr",
      { "aria-selected": String(store.get("selection").has(star.key)) },
      h("td", {}, selected),
      h("td", {}, star.row),
      h("td", {}, `${star.site[0]}, ${star.site[1]}`),
      h("td", {}, fixed(star.at[0])),
      h("td", {}, fixed(star.at[1])),
      Object.keys(QUANTITIES).map((quantity) => cell(star, quantity)),
      h("td", {}, printed),
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
      h(
        "table",
        { class: "small", testid: "star-table" },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            heads.map((text) => h("th", { scope: "col" }, text)),
          ),
        ),
        body,
      ),
    ],
    { testid: "table-dialog", onclose: stop },
  );
  fill();
}
