// Panel of size fields: one value, gradients by dragging, a formula, a picture.

import { choice, follow, h, hint, part, section, segments, show, wide } from "../dom.js";
import { QUANTITIES, QUANTITY_NAMES } from "../format.js";
import { round, roundPoint } from "../geometry.js";
import { sizeAt, sizeTargets } from "../sheet.js";
import { sizeChanges } from "../plan/tools/gradient.js";
import { numberField, showFault } from "./fields.js";
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
  const design = () => store.get("sheet")?.design ?? {};
  const isOfRods = () => tool.path !== "stars";
  const present = () => sizeAt(design(), tool.path, QUANTITIES[settings.quantity].key);
  const isLine = () => tool.isLine;
  const choose = (kind) => store.set({ sizesKind: kind });
  const values = { number: 7, low: 4, high: 10 }; // of the kinds that are no gradients
  let shown = [0, 20]; // what the sliders reach
  const change = (value) => edits.design(sizeChanges(design(), tool.path, settings.quantity, value));
  const send = (value) => edits.once(() => change(value));

  const size = (label, key, of, rest) =>
    numberField({
      label,
      value: () => of[key],
      limits: () => shown,
      step: 0.1,
      digits: 2,
      testid: `gradient-${key}`,
      hidden: () => !isLine(),
      ...rest,
    });
  /** A number of the line, which is drawn while its slider moves. */
  const ofLine = (label, key, rest) => {
    const onchange = (value, isFinal) => {
      settings[key] = value;
      edits.begin();
      tool.apply();
      if (isFinal) edits.end();
    };
    return size(label, key, settings, { slider: true, onchange, ...rest });
  };
  /** Other sizes for black and white of the picture that the design has. */
  const ofPicture = (label, key) => {
    const onchange = (value) => {
      values[key] = value;
      if (isPicture(present().value)) send({ ...present().value, [key]: value });
    };
    return size(label, key, values, { testid: `image-${key}`, hidden: null, onchange });
  };
  function everywhere(value, isFinal) {
    values.number = value;
    edits.begin();
    change(value);
    const stars = store.get("sheet").stars.filter((star) => !star.removed);
    if (!isOfRods()) edits.preview(settings.quantity, new Map(stars.map((star) => [star.key, value])));
    if (isFinal) edits.end();
  }
  function redo() {
    edits.once(() => tool.apply());
    const { name } = QUANTITIES[settings.quantity];
    toast(`${name}: a ${tool.kind} gradient takes the place of all sizes that are not painted.`, {
      action: { text: "Undo", run: actions.undo },
    });
  }

  const text = h("textarea.text", {
    rows: 3,
    maxLength: 500,
    spellcheck: false,
    "aria-label": "Formula",
    testid: "formula",
    placeholder: "4 + 6*exp(-(r/30)**2)",
    oninput: () => say(null),
    onkeydown: (event) => {
      event.stopPropagation();
      if (event.key !== "Enter" || event.shiftKey) return;
      event.preventDefault();
      use();
    },
  });
  const fault = h("div.fault", { hidden: true, role: "alert", testid: "formula-fault" });
  const use = () => text.value.trim() && send({ formula: text.value.trim() });
  const say = (message) => showFault(fault, message, text, "bad-field");

  const choosePicture = () =>
    actions.upload("image", "image/png,image/jpeg", (value) => {
      const { size: extent, centre } = store.get("sheet").box;
      const { low, high } = values;
      send({ ...value, low, high, extent_mm: roundPoint(extent, 2), centre_mm: roundPoint(centre, 2) });
    });
  const listed = () =>
    sizeTargets(design())
      .filter(({ path }, k) => k < MAX_LISTED || path === tool.path)
      .map(({ path: value, text: name }) => ({ value, text: name }));
  const painted = () => store.get("sheet")?.stars.filter((star) => star.painted).map((star) => star.key) ?? [];

  let known;
  const profileText = () => JSON.stringify([store.get("document")?.path, tool.path, present()]);
  /** Takes over what the design has. */
  function read() {
    if (isOfRods() && settings.quantity === "length") settings.quantity = "thickness";
    known = profileText();
    const profile = tool.read();
    if (typeof profile === "number") choose("number");
    else if (profile?.formula) choose("formula");
    else if (isPicture(profile)) choose("image");
    const [least, most] = store.get("sheet")?.range(settings.quantity, store.get("inLaw") && !isOfRods()) ?? [0, 20];
    shown = [least, Math.min(most, QUANTITIES[settings.quantity].usual)];
    // the values of another size would be refused
    const allowed = (value, share) =>
      value >= shown[0] && value <= shown[1] ? value : round(shown[0] + share * (shown[1] - shown[0]), 2);
    Object.assign(settings, { from: allowed(settings.from, 0.5), to: allowed(settings.to, 0.25) });
    if (typeof profile === "number") values.number = profile;
    if (profile?.formula) text.value = profile.formula;
    const { low, high } = isPicture(profile) ? profile : values;
    Object.assign(values, isPicture(profile) ? { low, high } : { low: allowed(low, 0.25), high: allowed(high, 0.5) });
  }
  read();

  const page = [
    part(null, () => [listed(), tool.path], ([options]) => {
      if (options.length < 2) return [];
      const onchange = (path) => store.set({ sizesOf: path });
      return h("div.sizes-of", choice({ label: "Sizes of", testid: "sizes-of", options, value: tool.path, onchange }));
    }),
    segments({
      label: "Size",
      testid: "gradient-quantity",
      options: { ...QUANTITY_NAMES, length: { text: QUANTITY_NAMES.length, hidden: isOfRods } }, // rods are drawn
      value: () => settings.quantity,
      onchange: (value) => ((settings.quantity = value), update(true)),
    }),
    section("Sizes over the sheet"),
    segments({
      label: "Kind",
      testid: "gradient-kind",
      options: KINDS,
      value: () => tool.kind,
      onchange: (value) => (choose(value), update(), isLine() && redo()),
    }),
    hint("Drag a line in the plan, or its ends: the first value where you start, the second where you stop.", {
      hidden: () => !isLine(),
    }),
    ofLine("From", "from"),
    ofLine("To", "to"),
    ofLine("Power", "power", { unit: "", limits: () => [0.2, 5] }),
    size("Everywhere", "number", values, {
      slider: true,
      hidden: () => tool.kind !== "number",
      onchange: everywhere,
    }),
    h("div", { hidden: () => tool.kind !== "formula" }, [
      text,
      fault,
      hint("x, y and r in mm, theta in radians; + − * / **, sqrt, exp, sin, cos, min, max, clip, where."),
      wide("Use the formula", "use-formula", use, { keys: "Enter" }),
    ]),
    h("div", { hidden: () => tool.kind !== "image" }, [
      hint("A grey picture laid over the sheet: black gives the first size, white the second."),
      ofPicture("Black", "low"),
      ofPicture("White", "high"),
      wide("Choose a picture…", "upload-image", choosePicture, { icon: "upload" }),
    ]),
    wide("Same as all lines", "drop-own-size", () => send(null), {
      hidden: () => !tool.path.startsWith("rods.") || !present().isOwn,
    }),
    part(null, painted, (keys) => {
      const said = keys.length === 1 ? "1 star has a painted size" : `${keys.length} stars have painted sizes`;
      const drop = () => edits.once(() => edits.reset(keys));
      if (!keys.length) return [];
      return [hint(`${said}; they stay as they are.`), wide("Drop painted sizes", "drop-painted", drop)];
    }),
  ];
  function update(isRead = false) {
    if (isRead) read();
    show(page);
    tool.plan.invalidate();
  }
  follow(on, ["sheet"], page);
  on(["sizesOf"], () => update(true));
  // what is chosen, or refused, stays until the design gets other sizes or another design is open
  on(["document"], () => edits.isWaiting || profileText() === known || update(true));
  on(
    ["problem"],
    ({ problem }) => /^(stars|rods)\./.test(problem?.field ?? "") && tool.kind === "formula" && say(problem.text),
  );
  return page;
}
