// Panel of size fields: one value, gradients by dragging, a formula, a picture.

import { button, choice, h, hint, refresh, section, segments } from "../dom.js";
import { QUANTITIES, QUANTITY_NAMES } from "../format.js";
import { round, roundPoint } from "../geometry.js";
import { sizeAt, sizeTargets } from "../sheet.js";
import { sizeChanges } from "../plan/tools/gradient.js";
import { numberField } from "./fields.js";
import { toast } from "./toasts.js";

const KINDS = {
  radial: "Radial",
  linear: "Linear",
  number: { text: "Value", title: "The same everywhere" },
  formula: "Formula",
  image: "Image",
};

const MAX_LISTED = 200; // lines; others are chosen in the plan

const isPicture = (profile) => Boolean(profile?.image || profile?.pixels);

export function gradientPanel({ store, edits, tools, actions }, { on }) {
  const { tool } = tools.gradient;
  const { settings } = tool;
  const send = (value) =>
    edits.once(() => edits.design(sizeChanges(store.get("sheet").design, tool.path, settings.quantity, value)));
  const quantity = segments({
    label: "Size",
    testid: "gradient-quantity",
    options: QUANTITY_NAMES,
    value: settings.quantity,
    onchange: (value) => ((settings.quantity = value), read()),
  });
  const kind = segments({
    label: "Kind",
    testid: "gradient-kind",
    options: KINDS,
    value: settings.kind,
    onchange: (value) => ((settings.kind = value), show(), (value === "radial" || value === "linear") && redo()),
  });
  const redo = () => {
    edits.once(() => tool.apply());
    const { name } = QUANTITIES[settings.quantity];
    toast(`${name}: a ${settings.kind} gradient takes the place of all sizes that are not painted.`, {
      action: { text: "Undo", run: actions.undo },
    });
  };
  const size = (label, key, value, rest) =>
    numberField({ label, value, min: 0, max: 20, step: 0.1, digits: 2, testid: `gradient-${key}`, ...rest });
  const part = (label, key, rest) => {
    const onchange = (value, isFinal) => ((settings[key] = value), edits.begin(), tool.apply(), isFinal && edits.end());
    return size(label, key, settings[key], { slider: true, ...rest, onchange });
  };
  const from = part("From", "from");
  const to = part("To", "to");
  const power = part("Power", "power", { unit: "", min: 0.2, max: 5 });
  const drag = hint("Drag a line in the plan, or its ends: the first value where you start, the second where you stop.");
  const number = size("Everywhere", "number", 7, {
    slider: true,
    onchange(value, isFinal) {
      edits.begin();
      edits.design(sizeChanges(store.get("sheet").design, tool.path, settings.quantity, value));
      const stars = store.get("sheet").stars.filter((star) => !star.removed);
      if (tool.path === "stars") edits.preview(settings.quantity, new Map(stars.map((star) => [star.key, value])));
      if (isFinal) edits.end();
    },
  });
  const text = h("textarea", {
    class: "text",
    rows: 3,
    maxLength: 500,
    spellcheck: false,
    "aria-label": "Formula",
    testid: "formula",
    placeholder: "4 + 6*exp(-(r/30)**2)",
  });
  const fault = h("div", { class: "fault", hidden: true, role: "alert", testid: "formula-fault" });
  text.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter" && !event.shiftKey) {
      event.preventDefault();
      use();
    }
  });
  text.addEventListener("input", () => say(null));
  const use = () => text.value.trim() && send({ formula: text.value.trim() });
  const say = (message) => {
    fault.hidden = !message;
    fault.textContent = message ?? "";
    text.classList.toggle("bad-field", Boolean(message));
  };
  const formula = h(
    "div",
    {},
    text,
    fault,
    hint("x, y and r in mm, theta in radians; + − * / **, sqrt, exp, sin, cos, min, max, clip, where."),
    button({ text: "Use the formula", kind: "wide", keys: "Enter", testid: "use-formula", onclick: use }),
  );
  /** Other sizes for black and white of the picture that the design has. */
  const resized = (ends) => {
    const { value } = sizeAt(store.get("sheet").design, tool.path, QUANTITIES[settings.quantity].key);
    if (isPicture(value)) send({ ...value, ...ends });
  };
  const end = (label, key, value) =>
    size(label, key, value, { testid: `image-${key}`, onchange: (entered) => resized({ [key]: entered }) });
  const low = end("Black", "low", 4);
  const high = end("White", "high", 10);
  const image = h(
    "div",
    {},
    hint("A grey picture laid over the sheet: black gives the first size, white the second."),
    low.element,
    high.element,
    button({
      icon: "upload",
      text: "Choose a picture…",
      kind: "wide",
      testid: "upload-image",
      onclick: () =>
        actions.upload("image", "image/png,image/jpeg", (value) => {
          const { size: extent, centre } = store.get("sheet").box;
          const ends = { low: Number(low.input.value), high: Number(high.input.value) };
          send({ ...value, ...ends, extent_mm: roundPoint(extent, 2), centre_mm: roundPoint(centre, 2) });
        }),
    }),
  );
  const painted = h("div", {});
  function show() {
    const isLine = settings.kind === "radial" || settings.kind === "linear";
    for (const one of [from, to, power]) one.element.hidden = !isLine;
    drag.hidden = !isLine;
    number.element.hidden = settings.kind !== "number";
    formula.hidden = settings.kind !== "formula";
    image.hidden = settings.kind !== "image";
    kind.set(settings.kind);
    tool.plan.invalidate();
  }
  let known;
  const profileText = () => {
    const { design = {} } = store.get("sheet") ?? {};
    return JSON.stringify([store.get("document")?.path, tool.path, sizeAt(design, tool.path, QUANTITIES[settings.quantity].key)]);
  };
  const targets = h("div", { class: "sizes-of" });
  const own = button({
    text: "Same as all lines",
    kind: "wide",
    testid: "drop-own-size",
    onclick: () => send(null),
  });
  /** What the sizes are of, if there is a choice. */
  function offer() {
    const design = store.get("sheet")?.design ?? {};
    const all = sizeTargets(design);
    refresh(targets, [all, tool.path], () =>
      all.length < 2
        ? []
        : choice({
            label: "Sizes of",
            testid: "sizes-of",
            options: all
              .filter(({ path }, k) => k < MAX_LISTED || path === tool.path)
              .map(({ path: value, text: name }) => ({ value, text: name })),
            value: tool.path,
            onchange: (path) => store.set({ sizesOf: path }),
          }).element,
    );
    own.hidden = !tool.path.startsWith("rods.") || !sizeAt(design, tool.path, QUANTITIES[settings.quantity].key).isOwn;
  }
  /** Shows what the design has. */
  function read() {
    offer();
    const isOfRods = tool.path !== "stars";
    quantity.element.querySelector("[data-testid='gradient-quantity-length']").hidden = isOfRods; // rods are drawn
    if (isOfRods && settings.quantity === "length") settings.quantity = "thickness";
    quantity.set(settings.quantity);
    known = profileText();
    const profile = tool.read();
    if (typeof profile === "number") ((settings.kind = "number"), number.set(profile));
    else if (profile?.formula) ((settings.kind = "formula"), (text.value = profile.formula));
    else if (isPicture(profile)) settings.kind = "image";
    const [least, most] = store.get("sheet")?.range(settings.quantity, store.get("inLaw") && !isOfRods) ?? [0, 20];
    const shown = Math.min(most, QUANTITIES[settings.quantity].usual);
    for (const one of [from, to, number, low, high]) one.limits(least, shown);
    // the values of another size would be refused
    const allowed = (value, share) => (value >= least && value <= shown ? value : round(least + share * (shown - least), 2));
    Object.assign(settings, { from: allowed(settings.from, 0.5), to: allowed(settings.to, 0.25) });
    low.set(isPicture(profile) ? profile.low : allowed(Number(low.input.value), 0.25));
    high.set(isPicture(profile) ? profile.high : allowed(Number(high.input.value), 0.5));
    from.set(settings.from);
    to.set(settings.to);
    power.set(settings.power);
    show();
  }
  function count() {
    const keys = store.get("sheet")?.stars.filter((star) => star.painted).map((star) => star.key) ?? [];
    const said = keys.length === 1 ? "1 star has a painted size" : `${keys.length} stars have painted sizes`;
    const drop = button({
      text: "Drop painted sizes",
      kind: "wide",
      testid: "drop-painted",
      onclick: () => edits.once(() => edits.reset(keys)),
    });
    painted.replaceChildren(...(keys.length ? [hint(`${said}; they stay as they are.`), drop] : []));
  }
  on(["sheet"], () => {
    from.set(settings.from);
    to.set(settings.to);
    count();
  });
  on(["sizesOf"], read);
  // what is chosen, or refused, stays until the design gets other sizes or another design is open
  on(["document"], () => edits.isWaiting || profileText() === known || read());
  on(
    ["problem"],
    ({ problem }) => /^(stars|rods)\./.test(problem?.field ?? "") && settings.kind === "formula" && say(problem.text),
  );
  read();
  count();
  return [
    targets,
    quantity.element,
    section("Sizes over the sheet"),
    kind.element,
    drag,
    from.element,
    to.element,
    power.element,
    number.element,
    formula,
    image,
    own,
    painted,
  ];
}
