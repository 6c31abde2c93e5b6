// Files that are dropped on the page: drawings go to their dialog, surfaces become the target.

import { h } from "./dom.js";
import { toast } from "./panels/toasts.js";

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
    else if (["obj", "stl", "ply"].includes(ending) && store.get("document")) actions.takeTarget(file);
    else toast(`${file.name} is no drawing: SVG, DXF and 3DM can be dropped here.`, { isBad: true });
  });
}
