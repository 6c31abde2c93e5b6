// The bars above plan and view.

import { button, choice, h, refresh } from "../dom.js";
import { QUANTITY_NAMES, mm } from "../format.js";
import { VIEWS } from "../view/camera.js";
import { FIELDS } from "../view/colours.js";
import { openPicture } from "./picture.js";

function toggle(store, key, rest) {
  const one = button({ ...rest, pressed: store.get(key), onclick: () => store.set({ [key]: !store.get(key) }) });
  store.on([key], () => one.setAttribute("aria-pressed", String(store.get(key))));
  return one;
}

export function buildPlanBar(element, { store, plan }) {
  const colour = choice({
    label: "Colour of the pattern",
    testid: "plan-colour",
    options: {
      none: "Plain pattern",
      ...Object.fromEntries(Object.entries(QUANTITY_NAMES).map(([value, name]) => [value, `By ${name.toLowerCase()}`])),
    },
    value: store.get("planColour"),
    onchange: (value) => store.set({ planColour: value }),
  });
  store.on(["planColour"], ({ planColour }) => colour.set(planColour)); // the brush chooses it, too
  element.append(
    colour.element,
    h("span", { class: "gap" }),
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
  );
}

export function buildViewBar(element, studio) {
  const { store, view } = studio;
  const colour = choice({
    label: "Colours of the sheet",
    testid: "view-colour",
    options: Object.entries(FIELDS)
      .filter(([value]) => value !== "distance") // the badge shows that
      .map(([value, { name }]) => ({ value, text: value === "none" ? "Plain sheet" : name })),
    value: store.get("viewColour"),
    onchange: (value) => store.set({ viewColour: value }),
  });
  const target = colour.element.querySelector('[value="target"]');
  const update = () => {
    const hasTarget = Boolean(store.get("state").target);
    const isCompared = Boolean(store.get("frame")?.hasBefore) && store.get("shown") === "distance";
    colour.element.disabled = isCompared;
    colour.element.title = isCompared ? "The colours show the distance to the preview" : "Colours of the sheet";
    target.disabled = !hasTarget;
    target.textContent = hasTarget ? "To the target" : "To the target (load one first)";
    if (!hasTarget && store.get("connection") === "open" && store.get("viewColour") === "target")
      store.set({ viewColour: "none" });
  };
  store.on(["frame", "shown", "state"], update);
  store.on(["viewColour"], ({ viewColour }) => colour.set(viewColour));
  update();
  const toggles = [
    toggle(store, "paintOnSheet", {
      icon: "brush",
      label: "Paint on the sheet; drag beside it to turn",
      keys: "D",
      testid: "paint-on-sheet",
    }),
    toggle(store, "orthographic", { icon: "ortho", label: "Orthographic", keys: "O", testid: "ortho" }),
    toggle(store, "showArms", { icon: "arms", label: "Arms", testid: "show-arms" }),
    toggle(store, "showBumps", { icon: "bumps", label: "Bumps", testid: "show-bumps" }),
  ];
  element.append(
    colour.element,
    h("span", { class: "gap" }),
    viewMenu({ store, view }),
    h("span", { class: "roomy" }, toggles),
    button({ icon: "fit", label: "Fit the view", keys: "F", testid: "fit-view", onclick: () => view.fit() }),
    button({ icon: "camera", label: "Save a picture", testid: "picture", onclick: () => openPicture(studio) }),
  );
}

const SHOWN_PARTS = { paintOnSheet: "Paint on the sheet", orthographic: "Orthographic", showArms: "Arms", showBumps: "Bumps" };

/** Named views, and the parts of the picture, whose buttons a narrow bar has no room for. */
function viewMenu({ store, view }) {
  const parts = Object.keys(SHOWN_PARTS).map((value) => h("option", { value }));
  const menu = h(
    "select",
    { class: "short", "aria-label": "View", title: "Named view (1 to 7), shown parts", testid: "named-view" },
    h("option", { value: "" }, "View"),
    h(
      "optgroup",
      { label: "Look from" },
      Object.entries(VIEWS).map(([value, { name }], k) => h("option", { value }, `${name} (${k + 1})`)),
    ),
    h("optgroup", { label: "Show" }, parts),
  );
  menu.addEventListener("change", () => {
    if (menu.value in SHOWN_PARTS) store.set({ [menu.value]: !store.get(menu.value) });
    else view.look(menu.value);
    menu.value = "";
  });
  const update = () =>
    parts.forEach((part) => (part.textContent = `${store.get(part.value) ? "✓ " : ""}${SHOWN_PARTS[part.value]}`));
  store.on(Object.keys(SHOWN_PARTS), update);
  update();
  return menu;
}

/** What two shapes side by side are. */
export function buildNames(element, { store }) {
  const update = () => {
    const beside = store.get("beside");
    const height = store.get("state").numbers.height_mm ?? store.get("frame")?.height_mm;
    element.hidden = !beside;
    refresh(element, [beside, height], () => [
      h("span", {}, `Now, ${mm(height)}`),
      h(
        "span",
        { testid: "beside-name" },
        h("i", {}, beside?.name),
        button({ icon: "close", label: "One shape", kind: "plain", testid: "beside-close", onclick: () => store.set({ beside: null }) }),
      ),
    ]);
  };
  store.on(["beside", "state", "frame"], update);
}

const WITHOUT_VIEW =
  "This browser does not draw in space: WebGL 2 is missing or switched off. Plan, numbers, verification and export work.";

/** One line below the view: why there is no picture, or why a shape cannot be computed. */
export function buildViewNote(element, { store, actions, view }) {
  const update = () => {
    const { problem } = store.get("state");
    const parts = [];
    if (!view) parts.push(h("span", { class: "strong", role: "alert", testid: "no-view" }, WITHOUT_VIEW));
    if (store.get("document") && problem) {
      const isInMaterial = /^(fabric|plastic)\./.test(problem.field ?? "");
      const place =
        problem.stars?.length || problem.at_mm
          ? button({ text: "Show the place", onclick: () => actions.showPlace(problem) })
          : isInMaterial
            ? button({ text: "Show the value", testid: "show-value", onclick: () => actions.showPage("sheet") })
            : null;
      const text = `${problem.text.replace(/\.?$/, ".")} The last good shape is shown.`;
      parts.push(h("span", { class: "strong problem", role: "alert" }, h("span", {}, text), place));
    }
    refresh(element, [problem, Boolean(store.get("document"))], () => parts);
  };
  store.on(["state", "document"], update);
  update();
  const { style } = element.parentElement; // badge and legend stand above the note
  new ResizeObserver(() => style.setProperty("--note", `${element.offsetHeight}px`)).observe(element);
}
