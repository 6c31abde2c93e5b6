// Part of the shape's panel: the target surface, how far the sheet is from it, and where it stands.

import { button, check, choice, figures, h, hint, labelled, refresh, section } from "../dom.js";
import { mm, size } from "../format.js";

const UNITS = { mm: "Millimetres", cm: "Centimetres", m: "Metres", in: "Inches" };

export function targetPart({ store, connection, actions }, { on }) {
  const element = h("div", { testid: "target-surface" });
  const place = (fields) => connection.send("target", fields);
  let distances = null; // of the last shape at rest

  function update() {
    const { target } = store.get("state");
    distances = [store.get("frame")?.target, distances].find((one) => one && one.version === target?.version) ?? null;
    const isReady = Boolean(store.get("document"));
    refresh(element, [target, distances, isReady, store.get("showTarget")], () => [
      section("Target surface"),
      ...(target ? shown(target) : [empty(isReady)]),
    ]);
  }

  function empty(isReady) {
    return [
      hint("Load the surface that the sheet should come to: it stands beside the sheet as a ghost, and the distance is measured."),
      button({
        icon: "upload",
        text: "Load OBJ, STL, PLY or 3DM",
        kind: "wide",
        testid: "load-target",
        disabled: !isReady,
        onclick: () => actions.upload("target", ".obj,.stl,.ply,.3dm", () => {}),
      }),
    ];
  }

  function shown(target) {
    const rows = [
      ["Distance, rms", distances ? mm(distances.rms_mm, 2) : "–"],
      ["Largest distance", distances ? mm(distances.max_mm, 2) : "–"],
      ["Size", size(target.size_mm, 1)],
    ];
    const unit = choice({
      label: "Unit of the file",
      testid: "target-unit",
      options: UNITS,
      value: target.unit,
      onchange: (value) => place({ unit: value }),
    });
    return [
      h("p", { class: "hint", testid: "target-name" }, `${target.name}, ${target.triangles} triangles`),
      figures(rows, "target-distance"),
      check({
        text: "Show it as a ghost",
        value: store.get("showTarget"),
        testid: "show-target",
        onchange: (value) => store.set({ showTarget: value }),
      }).element,
      labelled("Unit of the file", unit),
      h(
        "div",
        { class: "row wrap" },
        button({ text: "Lay on the sheet", testid: "fit-target", onclick: () => place({ do: "fit" }) }),
        button({
          text: "As in the file",
          testid: "file-target",
          disabled: !target.is_fitted,
          onclick: () => place({ do: "file" }),
        }),
        button({ text: "Remove", testid: "remove-target", onclick: () => place({ do: "remove" }) }),
      ),
    ];
  }

  on(["state", "frame", "document", "showTarget"], update);
  update();
  return element;
}
