// Part of the shape's panel: where the release from the flat print ends, other forms of the sheet, and its other side.

import { button, h, hint, refresh, section } from "../dom.js";
import { percent } from "../format.js";

export function formsPart(studio, { on }) {
  const { store, actions } = studio;
  const forms = h("div", {});
  const released = h("div", { testid: "release" });
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
    const { forms: others = [], searching, release } = store.get("state");
    const isSearching = Boolean(searching);
    const focused = document.activeElement;
    const hadFocus = focused === flip || forms.contains(focused);
    refresh(forms, [others, isSearching], () => (others.length > 1 ? list(others, isSearching) : []));
    const held = released.contains(focused) ? focused.dataset.testid : null;
    refresh(released, [release], () => (release ? releaseParts(release) : []));
    if (held) (released.querySelector(`[data-testid="${held}"]`) ?? flip).focus();
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

  function releaseParts({ progress, is_same: isSame, energy_percent: energy, apart_percent: apart, is_shown: isShown }) {
    if (progress) {
      const how = progress.of ? `, ${Math.floor((100 * progress.done) / progress.of)} %` : "";
      return [hint(`Releasing the flat print, to see whether it ends in this form${how}`)];
    }
    if (isSame) return [hint("Released from the flat print, the sheet takes this form too.")];
    if (isSame === null) return [hint("The release from the flat print ended in no stable form.")];
    return [
      section("Two exact forms", h("span", { class: "count" }, "2")),
      hint(`A print follows the release. They are ${percent(apart)} of the diameter apart.`),
      h(
        "ul",
        { class: "list" },
        h("li", {}, exactItem(false, "Nearest to the preview", isShown ? -energy / (1 + energy / 100) : 0, !isShown)),
        h("li", {}, exactItem(true, "Released from the flat print", isShown ? 0 : energy, isShown)),
      ),
    ];
  }

  const exactItem = (isReleased, text, energy, isShown) =>
    row(text, energy, isShown, {
      testid: `exact-form-${isReleased ? "released" : "preview"}`,
      onclick: () => actions.showExactForm(isReleased),
    });

  const item = (form, isSearching) =>
    row(form.is_shown ? "This form" : "Another form", form.energy_percent, form.is_shown, {
      title: form.name,
      testid: `form-${form.index}`,
      disabled: isSearching,
      onclick: () => actions.showForm(form.index),
    });

  function row(text, energy, isShown, props) {
    return h(
      "button",
      { type: "button", class: "item", "aria-current": String(Boolean(isShown)), ...props },
      h("span", { class: "grow" }, text),
      h("span", { class: "count" }, isShown ? "shown" : `energy ${energy >= 0 ? "+" : ""}${percent(energy)}`),
    );
  }

  on(["state", "frame"], update);
  update();
  return [released, forms, h("div", { class: "row" }, h("span", { class: "grow" }, flip), stop)];
}
