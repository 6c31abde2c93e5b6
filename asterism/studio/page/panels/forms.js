// Part of the shape's panel: other forms of the sheet, and its other side.

import { button, h, hint, refresh, section } from "../dom.js";
import { percent } from "../format.js";

export function formsPart(studio, { on }) {
  const { store, actions } = studio;
  const forms = h("div", {});
  const flip = button({
    icon: "flip",
    text: "Flip to the other side",
    kind: "wide",
    testid: "flip",
    onclick: actions.flip,
  });
  const stop = button({
    text: "Cancel",
    label: "Cancel the search",
    keys: "Escape",
    testid: "stop-search",
    onclick: actions.stop,
  });

  function update() {
    const { forms: others = [], searching } = store.get("state");
    const isSearching = Boolean(searching);
    const focused = document.activeElement;
    const hadFocus = focused === flip || forms.contains(focused);
    refresh(forms, [others, isSearching], () => (others.length > 1 ? list(others, isSearching) : []));
    flip.hidden = !store.get("state").has_preview;
    flip.disabled = !store.get("frame") || isSearching;
    flip.lastChild.textContent = searching === "flip" ? "Searching …" : "Flip to the other side";
    stop.hidden = !isSearching;
    // a button that is taken away hands the keyboard on
    if (isSearching && hadFocus) stop.focus();
    else if (!isSearching && focused === stop) flip.focus();
  }

  function list(others, isSearching) {
    return [
      section("Forms", h("span", { class: "count" }, String(others.length))),
      hint("The same print can take each of them. The lower the energy, the more stable the form."),
      h(
        "ul",
        { class: "list" },
        others.map((form) => h("li", {}, item(form, isSearching))),
      ),
    ];
  }

  function item(form, isSearching) {
    const sign = form.energy_percent >= 0 ? "+" : "";
    return h(
      "button",
      {
        type: "button",
        class: "item",
        "aria-current": String(Boolean(form.is_shown)),
        testid: `form-${form.index}`,
        disabled: isSearching,
        onclick: () => actions.showForm(form.index),
      },
      h("span", { class: "grow", title: form.name }, form.is_shown ? "This form" : "Another form"),
      h("span", { class: "count" }, form.is_shown ? "shown" : `energy ${sign}${percent(form.energy_percent)}`),
    );
  }

  on(["state", "frame"], update);
  update();
  return [forms, h("div", { class: "row" }, h("span", { class: "grow" }, flip), stop)];
}
