// The badge in the picture: the state of the shape, and what is shown of an exact shape and its preview.

import { MEANINGS, activityOf, dotOf } from "../badge.js";
import { button, h, refresh, segments } from "../dom.js";

export function buildBadge(element, { store, connection, actions }) {
  const state = h("div", { class: "state", role: "status", testid: "badge" });
  const shown = segments({
    label: "Shown shape",
    testid: "shown",
    options: {
      shape: "Exact",
      preview: "Preview",
      distance: { text: "Distance", title: "Distance of the exact shape from the preview" },
    },
    value: store.get("shown"),
    onchange: (value) => store.set({ shown: value }),
  });
  element.append(state, shown.element);
  const update = () => {
    const badge = store.get("badge");
    const { settling, settle_s: waits, release } = store.get("state");
    element.hidden = !store.get("document");
    const takesOther = release?.is_same === false && !release.is_shown;
    const hadFocus = state.contains(document.activeElement);
    refresh(state, [badge, settling, waits, takesOther], () => [
      h("i", { class: `dot ${dotOf(badge, settling)}`, "aria-hidden": "true" }),
      h("b", { title: MEANINGS[badge.kind], testid: "badge-words" }, badge.words),
      settling ? h("span", { class: "muted" }, activityOf({ state: { settling }, document: true })) : null,
      waits
        ? button({
            text: `Exact shape, about ${Math.ceil(waits)} s`,
            testid: "settle",
            onclick: () => connection.send("settle"),
          })
        : null,
      takesOther
        ? button({ text: "A print takes another form", testid: "show-released", onclick: () => actions.showExactForm(true) })
        : null,
    ]);
    const hasBoth = Boolean(store.get("frame")?.hasBefore);
    shown.element.hidden = !hasBoth;
    // a button that is taken away hands the keyboard on
    if (hadFocus && !state.contains(document.activeElement)) shown.element.querySelector("[tabindex='0']")?.focus();
    shown.set(store.get("shown"));
  };
  store.on(["badge", "state", "frame", "shown", "document"], update);
  update();
}
