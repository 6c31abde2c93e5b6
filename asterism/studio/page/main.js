// Wires the page together: connection, document, plan, view, panels, keys.

import { createActions } from "./actions.js";
import { Connection } from "./connection.js";
import { DARK, h, refresh } from "./dom.js";
import { listenToDrops } from "./drop.js";
import { Edits } from "./edits.js";
import { listenToKeys } from "./keys.js";
import { listen } from "./messages.js";
import { buildBadge, buildNames, buildPlanBar, buildViewBar, buildViewNote } from "./panels/bars.js";
import { brushPanel } from "./panels/brush.js";
import { gradientPanel } from "./panels/gradient.js";
import { buildInspector } from "./panels/inspector.js";
import { materialPanel } from "./panels/material.js";
import { needlesPanel } from "./panels/needles.js";
import { outlinePanel } from "./panels/outline.js";
import { pictureTitle } from "./panels/picture.js";
import { rulerPanel } from "./panels/ruler.js";
import { selectionPanel } from "./panels/selection.js";
import { shapePanel } from "./panels/shape.js";
import { buildStart } from "./panels/start.js";
import { buildStatus } from "./panels/status.js";
import { keepToastsAbove, toast } from "./panels/toasts.js";
import { buildTools, buildTop } from "./panels/top.js";
import { weightPanel } from "./panels/weight.js";
import { PlanCanvas } from "./plan/canvas.js";
import { tooLarge } from "./plan/draw.js";
import { BrushTool } from "./plan/tools/brush.js";
import { GradientTool } from "./plan/tools/gradient.js";
import { NeedleTool } from "./plan/tools/needles.js";
import { OutlineTool } from "./plan/tools/outline.js";
import { RulerTool } from "./plan/tools/ruler.js";
import { SelectTool } from "./plan/tools/select.js";
import { WeightTool } from "./plan/tools/weight.js";
import { createStore } from "./store.js";
import { KeptShapes } from "./view/kept.js";
import { listenToView } from "./view/pointer.js";
import { Target } from "./view/target.js";
import { View } from "./view/view.js";

const $ = (id) => document.getElementById(id);

const store = createStore();
const studio = { store, opened: 0 };
const handlers = {}; // of the connection, which does not open before they are there
studio.connection = new Connection(handlers);
studio.edits = new Edits(store, studio.connection);
studio.plan = new PlanCanvas($("plan-canvas"), store);
const needsStars = true;
studio.tools = {
  select: { title: "Select", keys: "V", tool: new SelectTool(studio), panel: selectionPanel, needsStars },
  brush: { title: "Brush", keys: "B", tool: new BrushTool(studio), panel: brushPanel },
  gradient: { title: "Sizes", keys: "G", tool: new GradientTool(studio), panel: gradientPanel },
  outline: { title: "Outline", keys: "O", tool: new OutlineTool(studio), panel: outlinePanel },
  needles: { title: "Needles", keys: "N", tool: new NeedleTool(studio), panel: needlesPanel },
  weight: { title: "Weight", keys: "W", tool: new WeightTool(studio), panel: weightPanel, needsStars },
  ruler: { title: "Ruler", keys: "R", tool: new RulerTool(studio), panel: rulerPanel },
};
try {
  const onFrame = (header) => studio.connection.acknowledge(header.frame);
  studio.view = new View($("view-canvas"), store, { onFrame, legend: $("legend") });
  studio.view.target = new Target(studio.view.renderer, store, () => studio.view.invalidate());
  listenToView(studio.view, studio);
  studio.kept = new KeptShapes($("beside-canvas"), store, studio.view);
} catch (error) {
  console.warn(error.message);
}
studio.actions = createActions(studio);
Object.assign(handlers, listen(studio));

buildTop($("top"), studio);
buildTools($("tools"), studio);
buildStatus($("status"), studio);
buildPlanBar($("plan-bar"), studio);
if (studio.view) buildViewBar($("view-bar"), studio);
buildBadge($("badge"), studio);
buildNames($("beside-names"), studio);
buildViewNote($("view-note"), studio);
buildStart($("start"), studio);
keepToastsAbove($("plan-note"), $("view-note"), $("badge"));
buildInspector($("inspector"), studio, { sheet: materialPanel, shape: shapePanel });
listenToKeys(studio);
listenToDrops(studio);
store.on(["showBumps"], ({ showBumps }) => studio.connection.send("bumps", { shown: showBumps }));

const HINT_DOT = "\u00a0· "; // between the parts of a hint
function showTool() {
  const { tool } = studio.tools[store.get("tool")];
  studio.plan.tool?.leave?.();
  studio.plan.tool = tool;
  studio.plan.canvas.style.cursor = tool.cursor;
  showHint();
  studio.plan.invalidate();
}

const fingers = matchMedia("(pointer: coarse)"); // a tablet, mostly without a keyboard
/** A hint without the parts that need keys. */
const withoutKeys = (hint) => hint.split(HINT_DOT).filter((part) => !/Shift|Alt|Ctrl|\[/.test(part)).join(HINT_DOT);

/** What the pointer does in the plan; for some tools it depends on the design. */
function showHint() {
  const hint = fingers.matches ? withoutKeys(studio.plan.tool.hint) : studio.plan.tool.hint;
  const fault = tooLarge(store.get("sheet"));
  refresh($("plan-note"), [hint, fault], () => [
    fault ? h("span.strong.problem", { role: "status", testid: "too-large" }, fault) : null,
    h("span", hint),
  ]);
  $("plan-note").hidden = !hint && !fault;
}
store.on(["tool"], showTool);
store.on(["sheet", "sizesOf", "sizesKind", "hole"], showHint);
showTool();

// canvases get the colours of the scheme that is used
const DRAWN = "paper ink ink-soft text muted line-strong grid grid-strong accent needle weight warn bad";
for (const name of DRAWN.split(" "))
  CSS.registerProperty({ name: `--${name}`, syntax: "<color>", inherits: true, initialValue: "gray" });
const system = matchMedia(DARK);
function showTheme() {
  const theme = store.get("theme");
  document.documentElement.style.colorScheme = theme === "auto" ? (system.matches ? "dark" : "light") : theme;
}
system.addEventListener("change", showTheme);
store.on(["paintOnSheet"], () => studio.plan.tool?.leave?.()); // what is marked under the brush
store.on(["theme"], showTheme);
showTheme();

function divide() {
  const divider = $("divider");
  const show = (share) => {
    const kept = Math.min(80, Math.max(20, share));
    $("work").style.setProperty("--plan-share", `${kept}%`);
    divider.setAttribute("aria-valuenow", String(Math.round(kept)));
    store.set({ planShare: kept });
  };
  divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
  divider.addEventListener("pointermove", (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    const box = $("work").getBoundingClientRect();
    show((100 * (event.clientX - box.left)) / box.width);
  });
  divider.addEventListener("dblclick", () => show(50));
  divider.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -2, ArrowRight: 2 }[event.key];
    if (step) show(store.get("planShare") + step);
  });
  show(store.get("planShare"));
}
divide();

addEventListener("error", (event) => toast(`The page met an error: ${event.message}`, { isBad: true }));

/** State for tests and for the curious, besides what is in the store; read-only. */
const view = studio.view;
const shown = {
  revision: () => store.get("document")?.revision ?? null,
  shownRevision: () => store.get("frame")?.revision ?? null,
  stage: () => store.get("frame")?.stage ?? null,
  height: () => store.get("state").numbers?.height_mm ?? null,
  isSummarised: () => store.get("state").summary_revision === store.get("document")?.revision,
  engine: () => store.get("state").engine,
  connected: () => store.get("connection") === "open",
  drawn: () => view?.frames ?? 0,
  draw: () => () => view?.draw(),
  opened: () => studio.opened,
  isEditing: () => studio.edits.isOpen,
  isWaiting: () => studio.edits.isWaiting,
  selection: () => [...store.get("selection")],
  isBeside: () => Boolean(store.get("frame")?.hasBefore),
  isTwo: () => Boolean(view?.partner),
  contours: () => (view?.contourSurface.lineCount ?? 0) / 2,
  isGrey: () => view?.isGrey ?? false,
  isSmooth: () => view?.isSmooth ?? false,
  target: () => structuredClone(store.get("state").target ?? null),
  targetDistance: () => structuredClone(store.get("frame")?.target ?? null),
  ghost: () => (store.get("showTarget") ? (view?.target.surface.count ?? 0) / 3 : 0),
  camera: () => (view ? { turn: view.camera.turn, pitch: view.camera.pitch, distance: view.camera.distance } : null),
  weights: () => store.get("sheet")?.stars.map((star) => star.weight) ?? [],
  sizes: () => store.get("sheet")?.stars.map((star) => [...star.sizes]) ?? [],
  rods: () => structuredClone(store.get("sheet")?.rods ?? []),
  screenOf: () => (point) => studio.plan.toScreen(point),
  viewOf: () => (point) => view?.toScreen(point),
  pictureTitle: () => pictureTitle(store),
};
window.studio = new Proxy(Object.freeze({}), {
  get: (_, name) => (name in shown ? shown[name]() : structuredClone(store.get(name))),
});
