// The start screen: designs to begin with.

import { button, h, refresh, replace, section } from "../dom.js";
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

  const card = ({ kind = "", testid, shot, name, title, about, onclick }) =>
    h(
      "button",
      { type: "button", class: `card ${kind}`, testid, onclick },
      h("div", { class: "shot" }, shot),
      h("div", { class: "about" }, h("strong", { title }, name), h("span", {}, about)),
    );

  function example({ name, title, stars, rods, size_mm: extent }) {
    const shot = h("img", { src: `gallery/${name}.png`, alt: "" });
    shot.addEventListener("error", () => shot.replaceWith(icon("outline")));
    const about = `${rods ? plural(rods, "rod") : plural(stars, "star")}, ${size(extent)}`;
    const onclick = opening(() => actions.open({ gallery: name }));
    return card({ testid: `gallery-${name}`, shot, name: titled(name), title, about, onclick });
  }

  /** The design files of the folder; the rest of the page stays as it is when they change. */
  function showFiles({ files = [], files_left_out: left = 0 } = {}) {
    const focused = inFolder.contains(document.activeElement) && document.activeElement.dataset.testid;
    refresh(inFolder, [files, left], () =>
      files.length
        ? [
            section("In this folder"),
            h(
              "div",
              { class: "row wrap" },
              files.map((name) => {
                const onclick = opening(() => actions.open({ name }));
                return button({ icon: "open", text: name, testid: `file-${name}`, onclick });
              }),
            ),
            left
              ? h(
                  "p",
                  { class: "hint", testid: "files-left-out" },
                  `Not listed: ${plural(left, "older design")} of this folder. The command “asterism studio NAME.toml” opens one.`,
                )
              : null,
            section("Examples"),
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
    const blank = card({
      kind: "blank",
      testid: "new",
      shot: icon("plus"),
      name: "New sheet",
      about: "A hexagon of 37 stars to paint",
      onclick: opening(actions.startNew),
    });
    const drawn = card({
      kind: "blank",
      testid: "new-drawing",
      shot: icon("upload"),
      name: "From a drawing",
      about: "SVG, DXF or 3DM",
      onclick: actions.chooseDrawing,
    });
    const first = FIRST.map((name) => designs.find((design) => design.name === name)).filter(Boolean);
    const cards = (...all) => h("div", { class: "cards" }, all);
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
        cards(blank, drawn, first.map(example)),
        section("Other patterns"),
        cards(designs.filter(({ rods }) => rods).map(example)),
        section("Studies of one size"),
        cards(designs.filter(({ name, rods }) => !rods && !FIRST.includes(name)).map(example)),
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
