// The contact sheet, the table, and the details of one design.
// pixels of the largest picture on a card
const CARD_WIDTH = 204;
const CARD_HEIGHT = 150;

const fitting = ({ width_px: width, height_px: height }) => Math.min(CARD_WIDTH / width, CARD_HEIGHT / height);
// CSS pixels per mm at which the largest sheet fits its card
const commonScale = Math.min(...sweep.rows.filter((row) => row.picture).map(({ picture }) => fitting(picture) * picture.px_per_mm));

function pictureOf(row) {
  const { webp, width_px: width, px_per_mm: scale } = row.picture;
  const image = element("img", { alt: `design ${row.number}`, src: `data:image/webp;base64,${webp}` });
  image.style.width = `${width * (state.isOneScale ? commonScale / scale : fitting(row.picture))}px`;
  return image;
}

function entry(column, row) {
  return [element("dt", {}, ...breakable(withUnit(column))), element("dd", {}, shown(valueOf(row, column)))];
}

function card(row, near, open) {
  const plotted = [state.y, state.sort].map((key) => columns.find((each) => each.key === key && !each.isParameter));
  const listed = [...columns.filter((each) => each.isParameter), ...new Set(plotted.filter(Boolean))];
  const picture = row.picture ? pictureOf(row) : element("p", {}, row.problem);
  const note = row.problem !== null ? ["bad", "no shape"] : row.results.is_minimum === false ? ["bad", "not certified"] : row.results.not_reliable ? ["warn", "not reliable"] : null;
  const number = element("span", { class: "number" }, String(row.number));
  if (note) number.append(" ", element("span", { class: note[0] }, note[1]));
  return element(
    "button",
    { type: "button", class: "card", "data-number": row.number, onclick: () => open(row), onmouseenter: () => near(row.number), onmouseleave: () => near(null) },
    element("span", { class: "picture" }, picture),
    number,
    element("dl", {}, ...listed.flatMap((column) => entry(column, row))),
  );
}

function drawTable(rows, sortBy, near, open) {
  const known = columns.filter(isKnown);
  const heads = [["number", "number"], ...known.map((column) => [column.key, withUnit(column)]), ["problem", "problem"]];
  const head = heads.map(([key, text]) => element("th", {}, element("button", { type: "button", onclick: () => sortBy(key) }, text + mark(key))));
  const lines = rows.map((row) => {
    const cells = known.map((column) => {
      const value = valueOf(row, column);
      return element("td", { class: typeof value === "string" ? "text" : null, title: typeof value === "string" ? value : null }, shown(value));
    });
    return element(
      "tr",
      { "data-number": row.number, onclick: () => open(row), onmouseenter: () => near(row.number), onmouseleave: () => near(null) },
      element("td", {}, String(row.number)),
      ...cells,
      element("td", { class: "text bad", title: row.problem }, row.problem ?? ""),
    );
  });
  byId("table").replaceChildren(element("table", {}, element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...lines)));
}

const mark = (key) => (key !== state.sort ? "" : state.isDescending ? " ↓" : " ↑");

function openDetails(row) {
  byId("details-title").textContent = `Design ${row.number}`;
  const lines = Object.entries(row.parameters).map(([path, value]) => `${path} = ${JSON.stringify(value)}`);
  const body = [];
  if (row.picture) {
    const image = element("img", { alt: `design ${row.number}`, src: `data:image/webp;base64,${row.picture.webp}` });
    body.push(element("div", { class: "picture" }, image));
  } else body.push(element("p", { class: "bad" }, row.problem));
  body.push(element("pre", { "aria-label": "Entries of the design" }, lines.join("\n")));
  const known = columns.filter((column) => !column.isParameter && !["warnings", "not_reliable"].includes(column.name));
  if (row.results) {
    for (const name of ["not_reliable", "warnings"]) if (row.results[name]) body.push(element("p", { class: "warn" }, row.results[name]));
    body.push(element("dl", {}, ...known.flatMap((column) => entry(column, row))));
  }
  byId("details-body").replaceChildren(...body);
  byId("details").showModal();
}
