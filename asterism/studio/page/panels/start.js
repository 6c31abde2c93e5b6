// The start screen: designs to begin with.

import { button, h, refresh, replace } from "../dom.js";
import { plural, size } from "../format.js";
import { icon } from "../icons.js";

// the order in which the examples are offered; the others follow below
const FIRST = ["dome", "bell", "roof", "tunnel", "u-shape", "doubly-curved", "tube", "cone", "star"];

const ASK_EVERY_MS = 2000; // other programs put designs into the folder

const SIZE_LETTERS = { l: "length", h: "thickness", w: "width" }; // as in the paper

const titled = (name) =>
  (name.charAt(0).toUpperCase() + name.slice(1))
    .replace(/^Fig(\d+)-(.)-/, (_, number, size) => `Figure ${number}, ${SIZE_LETTERS[size]} `)
    .replace(/^Fig(\d+)-/, "Figure $1, ")
    .replaceAll("-", " ")
    .replace("U shape", "U-shape");

export function buildStart(element, { store, connection, actions }) {
  element.setAttribute("role", "dialog");
  element.setAttribute("aria-label", "Open a design");
  element.dataset.testid = "start";

  const inFolder = h("div", { testid: "in-folder" });
  let built = null;

  /** Marks what was clicked until the design is there. */
  function opening(run) {
    return ({ currentTarget }) => {
      currentTarget.setAttribute("aria-busy", "true");
      run();
    };
  }

  function card(design) {
    const picture = h("img", { src: `gallery/${design.name}.png`, alt: "" });
    const shot = h("div", { class: "shot" }, picture);
    picture.addEventListener("error", () => shot.replaceChildren(icon("outline")));
    return h(
      "button",
      {
        type: "button",
        class: "card",
        testid: `gallery-${design.name}`,
        onclick: opening(() => actions.open({ gallery: design.name })),
      },
      shot,
      h(
        "div",
        { class: "about" },
        h("strong", { title: design.title }, titled(design.name)),
        h("span", {}, `${design.rods ? plural(design.rods, "rod") : plural(design.stars, "star")}${design.size_mm ? `, ${size(design.size_mm)}` : ""}`),
      ),
    );
  }

  /** The design files of the folder; the rest of the page stays as it is when they change. */
  function showFiles({ files = [], files_left_out: left = 0 } = {}) {
    const focused = inFolder.contains(document.activeElement) && document.activeElement.dataset.testid;
    refresh(inFolder, [files, left], () =>
      files.length
        ? [
            h("h2", { class: "section" }, "In this folder"),
            h(
              "div",
              { class: "row wrap" },
              files.map((name) =>
                button({
                  icon: "open",
                  text: name,
                  testid: `file-${name}`,
                  onclick: opening(() => actions.open({ name })),
                }),
              ),
            ),
            left
              ? h(
                  "p",
                  { class: "hint", testid: "files-left-out" },
                  `Not listed: ${plural(left, "older design")} of this folder. The command “asterism studio NAME.toml” opens one.`,
                )
              : null,
            h("h2", { class: "section" }, "Examples"),
          ]
        : [],
    );
    if (focused) [...inFolder.querySelectorAll("button")].find((one) => one.dataset.testid === focused)?.focus();
  }

  function update() {
    const gallery = store.get("gallery");
    const hasDocument = Boolean(store.get("document"));
    const isShown = store.get("startOpen") || (!hasDocument && store.get("connection") === "open" && gallery !== null);
    element.hidden = !isShown;
    if (!isShown) return;
    showFiles(gallery ?? undefined);
    const designs = gallery?.designs ?? [];
    const key = JSON.stringify([designs, hasDocument]);
    if (built === key) return;
    built = key;
    const blank = h(
      "button",
      { type: "button", class: "card blank", testid: "new", onclick: opening(actions.startNew) },
      h("div", { class: "shot" }, icon("plus")),
      h("div", { class: "about" }, h("strong", {}, "New sheet"), h("span", {}, "A hexagon of 37 stars to paint")),
    );
    const drawn = h(
      "button",
      { type: "button", class: "card blank", testid: "new-drawing", onclick: actions.chooseDrawing },
      h("div", { class: "shot" }, icon("upload")),
      h("div", { class: "about" }, h("strong", {}, "From a drawing"), h("span", {}, "SVG, DXF or 3DM")),
    );
    replace(
      element,
      h(
        "div",
        { class: "inner" },
        h(
          "div",
          { class: "head" },
          h(
            "div",
            {},
            h("h1", {}, "What do you want to make?"),
            h(
              "p",
              { class: "lead" },
              "Plastic printed on stretched fabric, as stars or as other lines, makes it rise when it is released. Start from a sheet that works, or from an even one; everything can be changed.",
            ),
          ),
          h(
            "div",
            { hidden: !hasDocument },
            button({
              icon: "close",
              text: "Back to the design",
              keys: "Escape",
              testid: "start-close",
              onclick: () => store.set({ startOpen: false }),
            }),
          ),
        ),
        inFolder,
        h(
          "div",
          { class: "cards" },
          blank,
          drawn,
          designs
            .filter(({ name }) => FIRST.includes(name))
            .sort((a, b) => FIRST.indexOf(a.name) - FIRST.indexOf(b.name))
            .map(card),
        ),
        h("h2", { class: "section" }, "Other patterns"),
        h("div", { class: "cards" }, designs.filter(({ rods }) => rods).map(card)),
        h("h2", { class: "section" }, "Studies of one size"),
        h("div", { class: "cards" }, designs.filter(({ name, rods }) => !rods && !FIRST.includes(name)).map(card)),
      ),
    );
  }
  store.on(["gallery", "document", "startOpen", "connection"], update);
  store.on(["document", "problem"], () =>
    element.querySelectorAll("[aria-busy]").forEach((one) => one.removeAttribute("aria-busy")),
  );
  setInterval(() => !element.hidden && !document.hidden && connection.send("gallery"), ASK_EVERY_MS);
  update();
}
