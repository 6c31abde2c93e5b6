// The controls, and what follows from a change of them.
function near(number) {
  for (const marked of document.querySelectorAll(".is-near")) marked.classList.remove("is-near");
  if (number !== null) for (const each of document.querySelectorAll(`[data-number="${number}"]`)) each.classList.add("is-near");
}

function sortBy(key) {
  state.isDescending = state.sort === key && !state.isDescending;
  state.sort = key === "problem" ? "number" : key;
  draw();
}

function draw() {
  const rows = sorted();
  byId("sort").value = state.sort;
  byId("direction").textContent = state.isDescending ? "↓ descending" : "↑ ascending";
  byId("count").textContent = rows.length === sweep.rows.length ? `${rows.length} designs` : `${rows.length} of ${sweep.rows.length} designs`;
  byId("scale").setAttribute("aria-pressed", String(state.isOneScale));
  byId("scale").hidden = state.view !== "cards";
  for (const view of ["cards", "table"]) {
    byId(view).hidden = state.view !== view || !rows.length;
    byId(`view-${view}`).setAttribute("aria-pressed", String(state.view === view));
  }
  byId("empty").hidden = rows.length > 0;
  if (state.view === "cards") byId("cards").replaceChildren(...rows.map((row) => card(row, near, openDetails)));
  else drawTable(rows, sortBy, near, openDetails);
  drawPlot(rows, near, openDetails);
}

function options(id, listed, chosen, change) {
  byId(id).replaceChildren(...listed.map(([value, text]) => element("option", { value }, text)));
  byId(id).value = chosen;
  byId(id).addEventListener("change", () => {
    change(byId(id).value);
    draw();
  });
}

function chips(column, texts) {
  const buttons = texts.map((text) =>
    element("button", { type: "button", "aria-pressed": "false", onclick: (event) => {
      const chosen = (state.chosen[column.key] ??= new Set());
      if (!chosen.delete(text)) chosen.add(text);
      event.currentTarget.setAttribute("aria-pressed", String(chosen.has(text)));
      draw();
    } }, text),
  );
  return element("div", { class: "chips", role: "group", "aria-label": column.label }, ...buttons);
}

function range(column) {
  const limit = (end, text) =>
    element("input", { type: "number", step: "any", "aria-label": `${column.label} ${text}`, placeholder: text, oninput: (event) => {
      const ends = (state.ranges[column.key] ??= [null, null]);
      ends[end] = event.currentTarget.value === "" ? null : Number(event.currentTarget.value);
      draw();
    } });
  return element("div", { class: "range" }, limit(0, "from"), limit(1, "to"));
}

function drawFilters() {
  const fields = [];
  for (const column of columns.filter((each) => each.isParameter)) {
    const texts = [...new Set(sweep.rows.map((row) => shown(valueOf(row, column))))];
    if (texts.length < 2) continue;
    fields.push(element("span", {}, ...breakable(column.label)), texts.length <= MAX_CHIPS ? chips(column, texts) : range(column));
  }
  const listed = numeric.filter((column) => !column.isParameter);
  const place = element("div", {});
  const choice = element("select", { "aria-label": "Quantity of the filter", onchange: () => choose() }, ...listed.map((column) => element("option", { value: column.key }, withUnit(column))));
  const choose = () => {
    for (const column of listed) delete state.ranges[column.key];
    place.replaceChildren(range(listed.find((column) => column.key === choice.value)));
    draw();
  };
  if (listed.length) fields.push(choice, place);
  const only = element("button", { type: "button", "aria-pressed": "false", onclick: (event) => {
    state.hidesFailed = !state.hidesFailed;
    event.currentTarget.setAttribute("aria-pressed", String(state.hidesFailed));
    draw();
  } }, "Certified shapes only");
  fields.push(element("span", {}, "equilibrium"), element("div", {}, only));
  byId("filters").replaceChildren(...fields);
  if (listed.length) place.replaceChildren(range(listed[0]));
}

function begin() {
  byId("name").textContent = sweep.name;
  byId("about").textContent = sweep.about;
  const across = numeric.filter((column) => column.isParameter && new Set(sweep.rows.map((row) => valueOf(row, column))).size > 1);
  const upwards = numeric.filter((column) => !column.isParameter);
  state.x = (across[0] ?? numeric[0])?.key ?? "";
  state.y = (upwards.find((column) => column.name === "height_mm") ?? upwards[0])?.key ?? "";
  const others = columns.filter((column) => column.isParameter && column.key !== state.x);
  state.colour = others[0]?.key ?? "";
  const listed = numeric.map((column) => [column.key, withUnit(column)]);
  options("plot-x", listed, state.x, (value) => (state.x = value));
  options("plot-y", listed, state.y, (value) => (state.y = value));
  const coloured = columns.filter((column) => isKnown(column) && column.name !== "warnings");
  options("plot-colour", [["", "one colour"], ...coloured.map((column) => [column.key, withUnit(column)])], state.colour, (value) => (state.colour = value));
  options("sort", [["number", "number"], ...coloured.map((column) => [column.key, withUnit(column)])], state.sort, (value) => (state.sort = value));
  byId("direction").addEventListener("click", () => { state.isDescending = !state.isDescending; draw(); });
  byId("scale").addEventListener("click", () => { state.isOneScale = !state.isOneScale; draw(); });
  for (const view of ["cards", "table"]) byId(`view-${view}`).addEventListener("click", () => { state.view = view; draw(); });
  byId("reset").addEventListener("click", () => {
    Object.assign(state, { chosen: {}, ranges: {}, hidesFailed: false });
    drawFilters();
    draw();
  });
  byId("close").addEventListener("click", () => byId("details").close());
  drawFilters();
  draw();
}

begin();
