// Panel of size fields: one value, gradients by dragging, a formula, a picture.

import { button, choice, h, hint, refresh, section, segments } from "../dom.js";
import { QUANTITIES } from "../format.js";
import { sizeAt, sizeTargets } from "../sheet.js";
import { sizeChanges } from "../plan/tools/gradient.js";
import { numberField } from "./fields.js";
import { toast } from "./toasts.js";

const KINDS = [
  { value: "radial", text: "Radial" },
  { value: "linear", text: "Linear" },
  { value: "number", text: "Value", title: "The same everywhere" },
  { value: "formula", text: "Formula" },
  { value: "image", text: "Image" },
];

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
    options: Object.entries(QUANTITIES).map(([value, { name }]) => ({ value, text: name })),
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
  const part = (label, key, rest = {}) =>
    numberField({
      label,
      value: settings[key],
      min: 0,
      max: 20,
      step: 0.1,
      digits: 2,
      slider: true,
      testid: `gradient-${key}`,
      ...rest,
      onchange: (value, isFinal) => ((settings[key] = value), edits.begin(), tool.apply(), isFinal && edits.end()),
    });
  const from = part("From", "from");
  const to = part("To", "to");
  const power = part("Power", "power", { unit: "", min: 0.2, max: 5 });
  const drag = hint("Drag a line in the plan, or its ends: the first value where you start, the second where you stop.");
  const number = numberField({
    label: "Everywhere",
    value: 7,
    min: 0,
    max: 20,
    step: 0.1,
    digits: 2,
    slider: true,
    testid: "gradient-number",
    onchange: (value, isFinal) => (
      edits.begin(),
      edits.design(sizeChanges(store.get("sheet").design, tool.path, settings.quantity, value)),
      tool.path === "stars" &&
        edits.preview(
          settings.quantity,
          new Map(
            store
              .get("sheet")
              .stars.filter((star) => !star.removed)
              .map((star) => [star.key, value]),
          ),
        ),
      isFinal && edits.end()
    ),
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
  const low = numberField({
    label: "Black",
    value: 4,
    min: 0,
    max: 20,
    step: 0.1,
    digits: 2,
    testid: "image-low",
    onchange: (value) => resized({ low: value }),
  });
  const high = numberField({
    label: "White",
    value: 10,
    min: 0,
    max: 20,
    step: 0.1,
    digits: 2,
    testid: "image-high",
    onchange: (value) => resized({ high: value }),
  });
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
          const { size, centre } = store.get("sheet").box;
          const numbers = [low, high].map((one) => Number(one.input.value));
          send({
            ...value,
            low: numbers[0],
            high: numbers[1],
            extent_mm: size.map((one) => Number(one.toFixed(2))),
            centre_mm: centre.map((one) => Number(one.toFixed(2))),
          });
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
              .map(({ path, text }) => ({ value: path, text })),
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
    for (const [key, share] of [
      ["from", 0.5],
      ["to", 0.25],
    ]) {
      // the values of another size would be refused
      if (settings[key] < least || settings[key] > shown) settings[key] = Number((least + share * (shown - least)).toFixed(2));
    }
    for (const [end, key, share] of [
      [low, "low", 0.25],
      [high, "high", 0.5],
    ]) {
      const entered = Number(end.input.value);
      const isAllowed = entered >= least && entered <= shown;
      if (isPicture(profile)) end.set(profile[key]);
      else if (!isAllowed) end.set(Number((least + share * (shown - least)).toFixed(2)));
    }
    from.set(settings.from);
    to.set(settings.to);
    power.set(settings.power);
    show();
  }
  function count() {
    const keys =
      store
        .get("sheet")
        ?.stars.filter((star) => star.painted)
        .map((star) => star.key) ?? [];
    painted.replaceChildren(
      ...(keys.length
        ? [
            hint(
              `${keys.length === 1 ? "1 star has a painted size" : `${keys.length} stars have painted sizes`}; they stay as they are.`,
            ),
            button({
              text: "Drop painted sizes",
              kind: "wide",
              testid: "drop-painted",
              onclick: () => edits.once(() => edits.reset(keys)),
            }),
          ]
        : []),
    );
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

/** Panel of the ruler. */
export function rulerPanel({ store }, { on }) {
  const list = h("dl", { class: "figures", testid: "measured" });
  const empty = hint("Drag in the plan from one place to another.");
  function update() {
    const measured = store.get("measured");
    empty.hidden = Boolean(measured);
    list.replaceChildren();
    if (!measured) return;
    const stretch = store.get("sheet")?.design.fabric?.stretch ?? 1.35;
    const [sx, sy] = Array.isArray(stretch) ? stretch : [stretch, stretch];
    const [[ax, ay], [bx, by]] = measured.line;
    const rows = [
      ["On the print", measured.printed],
      ["Across, x", Math.abs(bx - ax)],
      ["Upwards, y", Math.abs(by - ay)],
      ["Released fabric without stars", Math.hypot((bx - ax) / sx, (by - ay) / sy)],
    ];
    for (const [name, value] of rows) list.append(h("dt", {}, name), h("dd", {}, `${value.toFixed(1)} mm`));
  }
  on(["measured"], update);
  update();
  return [section("Distance"), empty, list];
}
