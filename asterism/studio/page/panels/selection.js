// Panel of the selection: exact sizes, ring, same size, remove and restore.

import { bound, button, follow, h, hint, section, segments } from "../dom.js";
import { QUANTITIES, plural } from "../format.js";
import { ringKeys, sameSizeKeys } from "../plan/tools/select.js";
import { numberField } from "./fields.js";

export function selectionPanel({ store, edits, actions }, { on }) {
  const sheet = () => store.get("sheet");
  const stars = () => [...store.get("selection")].map((key) => sheet()?.byKey.get(key)).filter(Boolean);
  const keys = () => stars().map((star) => star.key);
  const isNone = () => stars().length === 0;
  const act = (text, onclick, testid, rest = {}) => button({ text, testid, onclick, ...rest });
  const select = (chosen) => store.set({ selection: new Set(chosen) });
  const wanted = (holds) => () => select(sheet().stars.filter(holds).map((star) => star.key));
  const fields = Object.entries(QUANTITIES).map(([quantity, { name, key, step, column }]) => {
    const values = () => stars().map((star) => star.sizes[column]);
    const isSame = () => values().every((value, _, [first]) => Math.abs(value - first) < 1e-6);
    return numberField({
      label: name,
      step,
      digits: 3,
      testid: `selected-${quantity}`,
      field: `stars.${key}`,
      limits: () => sheet()?.range(quantity, false) ?? [0, 100],
      value: () => (isSame() && values().length ? values()[0] : null),
      placeholder: () => (isSame() ? "" : [Math.min, Math.max].map((end) => end(...values()).toFixed(1)).join("–")),
      onchange: (value) => edits.once(() => edits.sizes(quantity, new Map(keys().map((one) => [one, value])))),
    });
  });
  return follow(on, ["selection", "sheet", "copied", "selecting"], [
    segments({
      label: "What a click or a lasso does",
      testid: "selecting",
      options: {
        new: "New",
        more: { text: "Add", title: "Add (Shift)" },
        less: { text: "Take away", title: "Take away (Alt)" },
      },
      ...bound(store, "selecting"),
    }),
    h("h2.section", h("span", () => (isNone() ? "No star selected" : `${plural(stars().length, "star")} selected`))),
    hint("Click a star in the plan or on the sheet. Drag a lasso to take several, double-click to take its ring.", {
      hidden: () => !isNone(),
    }),
    h("div", { hidden: isNone }, [
      fields,
      h("div.row.wrap", [
        act("Remove", actions.removeSelected, "remove", { icon: "trash", keys: "Delete" }),
        act("Restore", () => edits.once(() => edits.restore(keys())), "restore"),
        act("Drop painted sizes", () => edits.once(() => edits.reset(keys())), "reset"),
        act("Copy sizes", actions.copySizes, "copy-sizes", { keys: "Ctrl+C" }),
        act("Paste sizes", actions.pasteSizes, "paste-sizes", { keys: "Ctrl+V", disabled: () => !store.get("copied") }),
      ]),
    ]),
    section("Extend"),
    h("div.row.wrap", [
      act("All", actions.selectAll, "select-all"),
      act("Ring", () => select(stars().flatMap((star) => ringKeys(sheet(), star))), "select-ring", { disabled: isNone }),
      act("Same size", () => select(sameSizeKeys(sheet(), store.get("selection"))), "select-same", { disabled: isNone }),
      act("Invert", wanted((star) => !store.get("selection").has(star.key)), "select-invert"),
      act("Painted", wanted((star) => star.painted), "select-painted"),
    ]),
  ]);
}
