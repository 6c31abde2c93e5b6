// The start screen: designs to begin with.

import { button, h, hint, refresh, section } from "../dom.js";
import { capital, plural, size } from "../format.js";
import { icon } from "../icons.js";

// the order in which the examples are offered; the others follow below
const FIRST = ["dome", "bell", "roof", "tunnel", "u-shape", "doubly-curved", "tube", "cone", "star"];

const LEAD =
  "Plastic printed on stretched fabric, as stars or as other lines, makes it rise when it is released. Start from a sheet that works, or from an even one; everything can be changed.";
const ASK_EVERY_MS = 2000; // other programs put designs into the folder

const SIZE_LETTERS = { l: "length", h: "thickness", w: "width" }; // as in the paper

const titled = (name) =>
  capital(name)
    .replace(/^Fig(\d+)-(.)-/, (_, number, size) => `Figure ${number}, ${SIZE_LETTERS[size]} `)
    .replace(/^Fig(\d+)-/, "Figure $1, ")
    .replaceAll("-", " ")
    .replace("U shape", "U-shape");

export function buildStart(element, { store, connection, actions }) {
  element.setAttribute("role", "dialog");
  element.setAttribute("aria-label", "Open a design");
  element.dataset.testid = "start";

  const inFolder = h("div", { testid: "in-folder" });

  /** Marks what was clicked until the design is there. */
  function opening(run) {
    return ({ currentTarget }) => {
      currentTarget.setAttribute("aria-busy", "true");
      run();
    };
  }

  const card = ({ kind = "", shot, name, title, about, ...rest }) =>
    h(`button.card${kind}`, { type: "button", ...rest }, [
      h("div.shot", shot),
      h("div.about", h("strong", { title }, name), h("span", about)),
    ]);

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
    const file = (name) =>
      button({ icon: "open", text: name, testid: `file-${name}`, onclick: opening(() => actions.open({ name })) });
    const others = `Not listed: ${plural(left, "older design")} of this folder. The command “asterism studio NAME.toml” opens one.`;
    refresh(inFolder, [files, left], () => {
      if (!files.length) return [];
      const more = left ? hint(others, { testid: "files-left-out" }) : null;
      return [section("In this folder"), h("div.row.wrap", files.map(file)), more, section("Examples")];
    });
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
    refresh(element, [designs, hasDocument], () => h("div.inner", content(designs, hasDocument)));
  }

  function content(designs, hasDocument) {
    const own = (testid, picture, name, about, onclick) =>
      card({ kind: ".blank", testid, shot: icon(picture), name, about, onclick });
    const back = button({
      icon: "close",
      text: "Back to the design",
      keys: "Escape",
      testid: "start-close",
      onclick: () => store.set({ startOpen: false }),
    });
    const first = FIRST.map((name) => designs.find((design) => design.name === name)).filter(Boolean);
    const cards = (...all) => h("div.cards", all);
    return [
      h("div.head", [
        h("div", h("h1", "What do you want to make?"), h("p.lead", LEAD)),
        h("div", { hidden: !hasDocument }, back),
      ]),
      inFolder,
      cards(
        own("new", "plus", "New sheet", "A hexagon of 37 stars to paint", opening(actions.startNew)),
        own("new-drawing", "upload", "From a drawing", "SVG, DXF or 3DM", actions.chooseDrawing),
        first.map(example),
      ),
      section("Other patterns"),
      cards(designs.filter(({ rods }) => rods).map(example)),
      section("Studies of one size"),
      cards(designs.filter(({ name, rods }) => !rods && !FIRST.includes(name)).map(example)),
    ];
  }
  store.on(["gallery", "document", "startOpen", "connection"], update);
  store.on(["document", "problem"], () =>
    element.querySelectorAll("[aria-busy]").forEach((one) => one.removeAttribute("aria-busy")),
  );
  setInterval(() => !element.hidden && !document.hidden && connection.send("gallery"), ASK_EVERY_MS);
  update();
}
