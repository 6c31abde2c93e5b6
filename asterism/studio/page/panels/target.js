// Part of the shape's panel: the target surface, how far the sheet is from it, and where it stands.

import { bound, button, check, choice, figures, h, hint, labelled, part, section, wide } from "../dom.js";
import { mm, size } from "../format.js";

const UNITS = { mm: "Millimetres", cm: "Centimetres", m: "Metres", in: "Inches" };

export function targetPart({ store, connection, actions }) {
  const place = (fields) => connection.send("target", fields);
  const load = () => actions.upload("target", ".obj,.stl,.ply,.3dm", () => {});
  let distances = null; // of the last shape at rest

  function known() {
    const { target = null } = store.get("state");
    distances = [store.get("frame")?.target, distances].find((one) => one && one.version === target?.version) ?? null;
    return { target, distances, isReady: Boolean(store.get("document")), showTarget: store.get("showTarget") };
  }

  return part("target-surface", known, ({ target, isReady }) => {
    if (!target)
      return [
        section("Target surface"),
        hint("Load the surface that the sheet should come to: it stands beside the sheet as a ghost, and the distance is measured."),
        wide("Load OBJ, STL, PLY or 3DM", "load-target", load, { icon: "upload", disabled: !isReady }),
      ];
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
    const move = (text, what, disabled = false) =>
      button({ text, testid: `${what}-target`, disabled, onclick: () => place({ do: what }) });
    return [
      section("Target surface"),
      hint(`${target.name}, ${target.triangles} triangles`, { testid: "target-name" }),
      figures(rows, "target-distance"),
      check({ text: "Show it as a ghost", testid: "show-target", ...bound(store, "showTarget") }),
      labelled("Unit of the file", unit),
      h("div.row.wrap", [
        move("Lay on the sheet", "fit"),
        move("As in the file", "file", !target.is_fitted),
        move("Remove", "remove"),
      ]),
    ];
  });
}
