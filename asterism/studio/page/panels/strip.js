// Part of the shape's panel: other forms of the sheet, kept designs and designs that were open, as small pictures.

import { button, h, hint, refresh, section, show, wide } from "../dom.js";
import { fixed, mm, percent, size } from "../format.js";

const SLOTS = ["A", "B", "C"];

export function stripPart(studio, { on }) {
  const { store, connection, actions, kept } = studio;
  const isSearching = () => Boolean(store.get("state").searching);
  const flipText = () => (store.get("state").searching === "flip" ? "Searching …" : "Flip to the other side");
  const flip = wide(flipText, "flip", actions.flip, {
    icon: "flip",
    hidden: () => !store.get("state").has_preview,
    disabled: () => !store.get("frame") || isSearching(),
  });
  const stop = button({
    text: "Cancel",
    label: "Cancel the search",
    keys: "Escape",
    testid: "stop-search",
    hidden: () => !isSearching(),
    onclick: actions.stop,
  });
  const strip = h("div.strip", { testid: "strip" });
  const about = () => [words(store.get("state").release), store.get("state").forms?.length > 1 ? FORMS : ""].join(" ");
  const said = h("div", { testid: "release" }, hint(about));
  let now = ""; // what the picture of the shown shape is of

  function update() {
    const focused = document.activeElement;
    const hadFocus = focused === flip || strip.contains(focused);
    const id = strip.contains(focused) ? focused.dataset.testid : null;
    const tiles = shownTiles();
    refresh(strip, [tiles, isSearching(), store.get("beside")], () => tiles.map(tile));
    if (id) (strip.querySelector(`[data-testid="${id}"]`) ?? flip).focus();
    show(said, flip, stop);
    // a button that is taken away hands the keyboard on
    if (isSearching() && hadFocus) stop.focus();
    else if (!isSearching() && focused === stop) flip.focus();
  }

  /** All tiles: {id, name, says, title, shape, run: what a click does}. */
  function shownTiles() {
    const { forms = [], release, slots = {}, designs = [], numbers = {} } = store.get("state");
    const frame = store.get("frame");
    if (!frame) return [];
    const height = numbers.height_mm ?? frame.height_mm;
    const { isStale } = store.get("badge");
    if (!isStale) now = `${connection.document} ${frame.revision} ${frame.stage} ${height}`;
    const tiles = [{ id: "now", name: "Now", says: mm(height), shape: null, key: now }];
    if (release?.is_same === false) {
      const { is_shown: isReleased, energy_percent: more, shapes = {} } = release;
      const energy = isReleased ? -more / (1 + more / 100) : more;
      const [id, name] = isReleased ? ["preview", "Nearest to the preview"] : ["released", "Released from the flat print"];
      const run = () => actions.showExactForm(!isReleased);
      tiles.push({ id: `exact-form-${id}`, name, says: energyOf(energy), shape: shapes[id], run });
    }
    for (const { index, is_shown: isShown, energy_percent: energy, name: title, shape } of forms)
      if (!isShown) {
        const run = () => actions.showForm(index);
        tiles.push({ id: `form-${index}`, name: "Another form", title, says: energyOf(energy), shape, run });
      }
    for (const slot of SLOTS) {
      const entry = slots[slot];
      const keep = () => connection.send("keep", { slot });
      const off = entry && Number.isFinite(height) ? entry.height_mm - height : 0;
      const change = Math.abs(off) < 0.05 ? "" : ` (${off > 0 ? "+" : ""}${fixed(off)} mm)`;
      const extent = entry?.extent_mm ? `, ${size(entry.extent_mm.slice(0, 2))}` : "";
      tiles.push(
        entry
          ? {
              id: `show-${slot}`,
              name: `${slot}${change}`,
              says: mm(entry.height_mm),
              title: `Show design ${slot}${extent}, ${entry.state}`,
              shape: entry.shape,
              run: () => connection.send("show", { slot }),
              slot,
              keep,
            }
          : { id: `keep-${slot}`, name: `Keep as ${slot}`, isEmpty: true, run: keep },
      );
    }
    for (const { name, shape, height_mm: high } of designs) {
      const run = () => actions.open({ name });
      tiles.push({ id: `design-${name}`, name: name.replace(/\.toml$/, ""), says: mm(high), shape, run });
    }
    return tiles;
  }

  function tile(one) {
    const { id, name, says, title = name, shape, key, slot, keep, run, isEmpty } = one;
    const picture = h("img", { alt: "" });
    if (kept && shape !== undefined && !isEmpty)
      kept.picture(shape, key).then((address) => (picture.src = address), () => {});
    const isBeside = Boolean(shape) && store.get("beside")?.shape === shape;
    const beside = isBeside ? null : { shape, name: [name, says].join(", ") };
    const props = { type: "button", title, "aria-current": String(id === "now"), testid: id, disabled: isSearching() };
    return h("div.tile", [
      h(isEmpty ? "button.empty" : "button", { ...props, onclick: run }, [
        isEmpty ? null : picture,
        h("span", name),
        says ? h("span.count", says) : null,
      ]),
      kept && shape
        ? button({
            icon: "columns",
            label: `${name} beside the shown shape`,
            kind: "plain",
            pressed: isBeside,
            testid: `beside-${id}`,
            onclick: () => store.set({ beside }),
          })
        : null,
      slot
        ? button({
            icon: "redo",
            label: `Replace ${slot} by what is shown`,
            kind: "plain again",
            testid: `keep-${slot}`,
            onclick: keep,
          })
        : null,
    ]);
  }

  on(["state", "frame", "badge", "beside"], update);
  update();
  return [section("Forms and designs"), strip, said, h("div.row", h("span.grow", flip), stop)];
}

const FORMS = "The lower the energy of a form, the more stable.";

const energyOf = (energy) => `energy ${energy >= 0 ? "+" : ""}${percent(energy)}`;

/** What is known of the release from the flat print. */
function words(release) {
  if (!release) return "";
  const { progress, is_same: isSame, apart_percent: apart } = release;
  if (progress) {
    const share = progress.of ? `, ${Math.floor((100 * progress.done) / progress.of)} %` : "";
    return `Releasing the flat print, to see whether it ends in this form${share}.`;
  }
  if (isSame) return "Released from the flat print, the sheet takes this form too.";
  if (isSame === null) return "The release from the flat print ended in no stable form.";
  return `A print follows the release: the two exact forms are ${percent(apart)} of the diameter apart.`;
}
