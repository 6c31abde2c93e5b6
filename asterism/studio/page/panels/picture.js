// The dialog that saves a picture of the sheet.

import { button, check, choice, dialog, h, labelled, show } from "../dom.js";
import { numberField } from "./fields.js";
import { toast } from "./toasts.js";

/** What a picture says about itself: the design and the state of its shape. */
export const pictureTitle = (store) => `${store.get("document")?.name ?? "sheet"} · ${store.get("badge").words}`;

const SIZES = ["1600 × 1200", "1920 × 1080", "3000 × 2000", "3000 × 3000"];
const OWN = "Own size";
const NONE = { selection: new Set(), under: new Set(), hover: null };
const SMALLEST_PX = 64;
const LARGEST_PX = 8192; // a larger picture takes more than 1 GB while it is drawn

export function openPicture({ store, view, actions }) {
  const max = Math.min(LARGEST_PX, view.renderer.largestPx);
  const sidesOf = (name) => name.split(" × ").map(Number);
  let size = sidesOf(SIZES[0]);
  let ground = "#ffffff";
  const name = store.get("document")?.name ?? "sheet";
  const sides = ["Width", "Height"].map((label, k) =>
    numberField({
      label,
      unit: "px",
      value: size[k],
      min: SMALLEST_PX,
      max,
      testid: `picture-${label.toLowerCase()}`,
      onchange: (value) => {
        size[k] = Math.round(value);
        pixels.set(SIZES.find((name) => name === size.join(" × ")) ?? OWN);
      },
    }),
  );
  const pixels = choice({
    label: "Size in pixels",
    testid: "picture-size",
    options: [...SIZES, OWN].map((value) => ({ value, text: value })),
    value: SIZES[0],
    onchange: (value) => {
      if (value === OWN) return sides[0].input.select();
      size = sidesOf(value);
      sides.forEach((one, k) => one.set(size[k]));
    },
  });
  const back = choice({
    label: "Background",
    testid: "picture-ground",
    options: { "#ffffff": "White", "": "Transparent" },
    value: ground,
    onchange: (value) => (ground = value),
  });
  const captions = check({ text: "Title and scale bar", value: true, testid: "picture-caption" });
  async function save() {
    const title = captions.box.checked ? pictureTitle(store) : null;
    // a picture shows the sheet as it is; the target is in it where the colours are the distance to it
    const plain = { ...NONE, showTarget: store.get("showTarget") && store.get("viewColour") === "target" };
    const shown = Object.fromEntries(Object.keys(plain).map((key) => [key, store.get(key)]));
    store.set(plain);
    const drawn = view.picture(...size, { background: ground, title });
    store.set(shown);
    const blob = await drawn;
    const link = h("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    element.close();
    toast(`Saved as ${link.download} among this browser's downloads.`);
  }
  const release = button({
    text: "GIF of the release",
    label: "An animated picture from the flat print to the exact shape, beside the design file",
    testid: "animate",
    disabled: () => store.get("badge").kind !== "exact",
    onclick: () => (actions.animate(), element.close()),
  });
  const element = dialog(
    "Save a picture of the sheet",
    [
      labelled("Size in pixels", pixels),
      sides,
      labelled("Background", back),
      captions,
      h("div.row", [
        button({ icon: "camera", text: "Save PNG", kind: "primary", testid: "picture-go", onclick: save }),
        release,
      ]),
    ],
    { testid: "picture-dialog", onclose: store.on(["badge"], () => show(release)) },
  );
}
