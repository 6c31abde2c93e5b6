// The bars above plan and view, and what stands in the picture: its state, names of two shapes, a note below.

import { MEANINGS, activityOf, dotOf } from "../badge.js";
import { append, bound, button, choice, follow, h, refresh, segments, show } from "../dom.js";
import { QUANTITY_NAMES, mm, seconds } from "../format.js";
import { VIEWS } from "../view/camera.js";
import { FIELDS } from "../view/colours.js";
import { openPicture } from "./picture.js";

function toggle(store, key, rest) {
  const { value: pressed, onchange } = bound(store, key);
  return button({ ...rest, pressed, onclick: () => onchange(!pressed()) });
}

export function buildPlanBar(element, { store, plan }) {
  const colours = Object.entries(QUANTITY_NAMES).map(([value, name]) => [value, `By ${name.toLowerCase()}`]);
  append(
    element,
    follow(store.on, ["planColour", "snap", "grid", "printArea"], [
      choice({
        label: "Colour of the pattern",
        testid: "plan-colour",
        options: { none: "Plain pattern", ...Object.fromEntries(colours) },
        ...bound(store, "planColour"), // the brush chooses it, too
      }),
      h("span.gap"),
      toggle(store, "snap", {
        icon: "snap",
        label: "Snap to corners, stars and millimetres",
        keys: "S",
        testid: "snap",
      }),
      toggle(store, "grid", { icon: "grid", label: "Millimetre grid", testid: "grid" }),
      toggle(store, "printArea", {
        icon: "printer",
        label: "Frame and printable area",
        keys: "P",
        testid: "plan-print-area",
      }),
      button({ icon: "fit", label: "Fit the plan", keys: "F", testid: "fit-plan", onclick: () => plan.fit() }),
    ]),
  );
}

export function buildViewBar(element, studio) {
  const { store, view } = studio;
  const hasTarget = () => Boolean(store.get("state").target);
  const isCompared = () => Boolean(store.get("frame")?.hasBefore) && store.get("shown") === "distance";
  const fields = Object.entries(FIELDS).filter(([value]) => value !== "distance"); // the badge shows that
  const names = { none: () => "Plain sheet", target: () => `To the target${hasTarget() ? "" : " (load one first)"}` };
  const options = () =>
    fields.map(([value, { name }]) => ({
      value,
      text: names[value]?.() ?? name,
      disabled: value === "target" && !hasTarget(),
    }));
  const partToggle = ([key, { name, label = name, ...rest }]) => toggle(store, key, { label, ...rest });
  append(
    element,
    follow(store.on, ["frame", "shown", "state", "viewColour", ...Object.keys(SHOWN_PARTS)], [
      choice({
        label: "Colours of the sheet",
        testid: "view-colour",
        options,
        ...bound(store, "viewColour"),
        disabled: isCompared,
        title: () => (isCompared() ? "The colours show the distance to the preview" : "Colours of the sheet"),
      }),
      h("span.gap"),
      viewMenu(studio),
      h("span.roomy", Object.entries(SHOWN_PARTS).map(partToggle)),
      button({ icon: "fit", label: "Fit the view", keys: "F", testid: "fit-view", onclick: () => view.fit() }),
      button({ icon: "camera", label: "Save a picture", testid: "picture", onclick: () => openPicture(studio) }),
    ]),
  );
  store.on(["state"], () => {
    const isLost = !hasTarget() && store.get("connection") === "open" && store.get("viewColour") === "target";
    if (isLost) store.set({ viewColour: "none" });
  });
}

const ABOUT_PAINTING = "Paint on the sheet; drag beside it to turn";
const SHOWN_PARTS = {
  paintOnSheet: { name: "Paint on the sheet", label: ABOUT_PAINTING, icon: "brush", keys: "D", testid: "paint-on-sheet" },
  orthographic: { name: "Orthographic", icon: "ortho", keys: "O", testid: "ortho" },
  showArms: { name: "Arms", icon: "arms", testid: "show-arms" },
  showBumps: { name: "Bumps", icon: "bumps", testid: "show-bumps" },
};

/** Named views, and the parts of the picture, whose buttons a narrow bar has no room for. */
function viewMenu({ store, view }) {
  const named = Object.entries(VIEWS).map(([value, { name }], k) => h("option", { value }, `${name} (${k + 1})`));
  const parts = Object.entries(SHOWN_PARTS).map(([value, { name }]) =>
    h("option", { value }, () => (store.get(value) ? `✓ ${name}` : name)),
  );
  const onchange = ({ target }) => {
    if (target.value in SHOWN_PARTS) store.set({ [target.value]: !store.get(target.value) });
    else view.look(target.value);
    target.value = "";
  };
  const title = "Named view (1 to 7), shown parts";
  return h("select.short", { "aria-label": "View", title, testid: "named-view", onchange }, [
    h("option", { value: "" }, "View"),
    h("optgroup", { label: "Look from" }, named),
    h("optgroup", { label: "Show" }, parts),
  ]);
}

/** The badge in the picture: the state of the shape, and what is shown of an exact shape and its preview. */
export function buildBadge(element, { store, connection, actions }) {
  const state = h("div.state", { role: "status", testid: "badge" });
  const shown = segments({
    label: "Shown shape",
    testid: "shown",
    options: {
      shape: "Exact",
      preview: "Preview",
      distance: { text: "Distance", title: "Distance of the exact shape from the preview" },
    },
    ...bound(store, "shown"),
    hidden: () => !store.get("frame")?.hasBefore,
  });
  append(element, [state, shown]);
  const update = () => {
    const badge = store.get("badge");
    const { settling, settle_s: waits, release } = store.get("state");
    const activity = settling ? activityOf({ state: { settling }, document: true }) : "";
    element.hidden = !store.get("document");
    const takesOther = release?.is_same === false && !release.is_shown;
    const hadFocus = state.contains(document.activeElement);
    refresh(state, [badge, activity, waits, takesOther], () => [
      h("i", { className: `dot ${dotOf(badge, activity)}`, "aria-hidden": "true" }),
      h("b", { title: MEANINGS[badge.kind], testid: "badge-words" }, badge.words),
      activity && h("span.muted", { "aria-live": "off" }, activity),
      waits &&
        button({
          text: `Exact shape, about ${seconds(Math.ceil(waits), 0)}`,
          testid: "settle",
          onclick: () => connection.send("settle"),
        }),
      takesOther &&
        button({
          text: "A print takes another form",
          testid: "show-released",
          onclick: () => actions.showExactForm(true),
        }),
    ]);
    show(shown);
    // a button that is taken away hands the keyboard on
    if (hadFocus && !state.contains(document.activeElement)) shown.element.querySelector("[tabindex='0']")?.focus();
  };
  store.on(["badge", "state", "frame", "shown", "document"], update);
  setInterval(() => store.get("state").settling && update(), 1000);
  update();
}

/** What two shapes side by side are. */
export function buildNames(element, { store }) {
  const update = () => {
    const beside = store.get("beside");
    const height = store.get("state").numbers.height_mm ?? store.get("frame")?.height_mm;
    element.hidden = !beside;
    const onclick = () => store.set({ beside: null });
    refresh(element, [beside, height], () => [
      h("span", `Now, ${mm(height)}`),
      h("span", { testid: "beside-name" }, [
        h("i", beside?.name ?? ""),
        button({ icon: "close", label: "One shape", kind: "plain", testid: "beside-close", onclick }),
      ]),
    ]);
  };
  store.on(["beside", "state", "frame"], update);
}

const WITHOUT_VIEW =
  "This browser does not draw in space: WebGL 2 is missing or switched off. Plan, numbers, verification and export work.";

/** One line below the view: why there is no picture, or why a shape cannot be computed. */
export function buildViewNote(element, { store, actions, view }) {
  function noteOf(problem) {
    const isInMaterial = /^(fabric|plastic)\./.test(problem.field ?? "");
    const text = `${problem.text.replace(/\.?$/, ".")} The last good shape is shown.`;
    return h("span.strong.problem", { role: "alert" }, [
      h("span", text),
      problem.stars?.length || problem.at_mm
        ? button({ text: "Show the place", onclick: () => actions.showPlace(problem) })
        : isInMaterial &&
          button({ text: "Show the value", testid: "show-value", onclick: () => actions.showPage("sheet") }),
    ]);
  }
  const update = () => {
    const problem = store.get("document") && store.get("state").problem;
    refresh(element, problem ?? null, () => [
      view ? null : h("span.strong", { role: "alert", testid: "no-view" }, WITHOUT_VIEW),
      problem ? noteOf(problem) : null,
    ]);
  };
  store.on(["state", "document"], update);
  update();
  const { style } = element.parentElement; // badge and legend stand above the note
  new ResizeObserver(() => style.setProperty("--note", `${element.offsetHeight}px`)).observe(element);
}
