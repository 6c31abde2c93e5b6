// Files that are dropped on the page: drawings go to their dialog, surfaces become the target.

import { h } from "./dom.js";
import { toast } from "./panels/toasts.js";

const SURFACES = ["obj", "stl", "ply"];

function refusal(name, ending) {
  if (ending === "toml") return `${name} is no drawing. Put a design into the folder of the studio: “Open” lists it.`;
  if (SURFACES.includes(ending)) return `${name} is a target surface: open a design first.`;
  return `${name} is no drawing: SVG, DXF and 3DM can be dropped here, and OBJ, STL and PLY as a target surface.`;
}

export function listenToDrops({ store, actions }) {
  const veil = h("div", { id: "drop", hidden: true, testid: "drop" }, "Drop a drawing: SVG, DXF or 3DM");
  document.body.append(veil);
  const hasFiles = (event) => event.dataTransfer?.types.includes("Files");
  let depth = 0; // elements that the pointer is over
  const leave = () => ((depth = 0), (veil.hidden = true));
  addEventListener("dragenter", (event) => {
    if (!hasFiles(event)) return;
    depth += 1;
    veil.hidden = false;
  });
  addEventListener("dragleave", (event) => hasFiles(event) && (depth -= 1) <= 0 && leave());
  addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    leave();
    const [file] = event.dataTransfer.files;
    const ending = file?.name.split(".").at(-1).toLowerCase();
    if (!file || document.querySelector("dialog[open]")) return;
    if (["svg", "dxf", "3dm"].includes(ending)) actions.takeDrawing(file);
    else if (SURFACES.includes(ending) && store.get("document")) actions.takeTarget(file);
    else toast(refusal(file.name, ending), { isBad: true });
  });
}
