// The plot of one column over another, as SVG.
const PLOT = { width: 460, height: 320, left: 58, right: 12, top: 12, bottom: 44 };
const GRADIENT = [[86, 116, 214], [33, 145, 160], [78, 170, 90], [222, 170, 40], [214, 84, 48]];
const GROUPS = ["#5674d6", "#d6542f", "#2f9a63", "#b0468f", "#b98a1d", "#2b97a8", "#7a5cc0", "#7b7f86"];
// more values of the colour's column are a gradient
const MAX_GROUPS = 8;

function ticks(low, high, most) {
  const rough = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((part) => part * power >= rough);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(10)));
}

function limits(values) {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const margin = high > low ? 0.06 * (high - low) : Math.abs(high) * 0.1 || 1;
  return [low - margin, high + margin];
}

function gradient(part) {
  const place = Math.min(Math.max(part, 0), 1) * (GRADIENT.length - 1);
  const below = Math.min(Math.floor(place), GRADIENT.length - 2);
  const mixed = GRADIENT[below].map((c, k) => Math.round(c + (place - below) * (GRADIENT[below + 1][k] - c)));
  return `rgb(${mixed.join(" ")})`;
}

function colouring(rows) {
  const column = columns.find((each) => each.key === state.colour);
  if (!column) return { of: () => "var(--accent)", legend: [] };
  const known = rows.map((row) => valueOf(row, column)).filter((value) => value !== null);
  const texts = [...new Set(known.map(shown))];
  if (isNumeric(column) && known.length) {
    const [low, high] = [Math.min(...known), Math.max(...known)];
    const part = (value) => (high > low ? (value - low) / (high - low) : 0.5);
    const listed = texts.length <= MAX_GROUPS ? [...new Set(known)].sort((a, b) => a - b) : [low, (low + high) / 2, high];
    const of = (row) => (valueOf(row, column) === null ? "var(--line-strong)" : gradient(part(valueOf(row, column))));
    return { of, legend: listed.map((value) => [gradient(part(value)), shown(value)]) };
  }
  const of = (row) => GROUPS[Math.max(texts.indexOf(shown(valueOf(row, column))), 0) % GROUPS.length];
  return { of, legend: texts.slice(0, MAX_GROUPS).map((text, k) => [GROUPS[k], text]) };
}

function svg(name, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

// rows that differ in the plotted parameter only are joined by a line
function curves(rows, x) {
  if (sweep.sampling !== "grid" || !x.isParameter) return [];
  const groups = new Map();
  for (const row of rows) {
    const others = sweep.parameters.filter((each) => each.path !== x.path).map((each) => shown(row.parameters[each.path]));
    const key = others.join("|");
    groups.set(key, [...(groups.get(key) ?? []), row]);
  }
  return [...groups.values()].map((group) => group.sort((a, b) => valueOf(a, x) - valueOf(b, x)));
}

function drawPlot(rows, near, open) {
  const x = columns.find((each) => each.key === state.x);
  const y = columns.find((each) => each.key === state.y);
  const known = x && y ? rows.filter((row) => isNumber(valueOf(row, x)) && isNumber(valueOf(row, y))) : [];
  byId("plot").replaceChildren();
  byId("legend").replaceChildren();
  if (!known.length) return;
  const [x0, x1] = limits(known.map((row) => valueOf(row, x)));
  const [y0, y1] = limits(known.map((row) => valueOf(row, y)));
  const across = (value) => PLOT.left + ((value - x0) / (x1 - x0)) * (PLOT.width - PLOT.left - PLOT.right);
  const up = (value) => PLOT.height - PLOT.bottom - ((value - y0) / (y1 - y0)) * (PLOT.height - PLOT.top - PLOT.bottom);
  const picture = svg("svg", { viewBox: `0 0 ${PLOT.width} ${PLOT.height}`, role: "img", "aria-label": `${y.label} over ${x.label}` });
  const floor = PLOT.height - PLOT.bottom;
  for (const value of ticks(y0, y1, 6)) {
    picture.append(svg("line", { class: "tick", x1: PLOT.left, x2: PLOT.width - PLOT.right, y1: up(value), y2: up(value) }));
    picture.append(svg("text", { x: PLOT.left - 6, y: up(value) + 4, "text-anchor": "end" }, shown(value)));
  }
  for (const value of ticks(x0, x1, 6)) {
    picture.append(svg("line", { class: "tick", x1: across(value), x2: across(value), y1: PLOT.top, y2: floor }));
    picture.append(svg("text", { x: across(value), y: floor + 16, "text-anchor": "middle" }, shown(value)));
  }
  picture.append(svg("line", { class: "axis", x1: PLOT.left, x2: PLOT.width - PLOT.right, y1: floor, y2: floor }));
  picture.append(svg("text", { x: (PLOT.left + PLOT.width) / 2, y: PLOT.height - 8, "text-anchor": "middle" }, withUnit(x)));
  const side = svg("text", { transform: `translate(14 ${(PLOT.top + floor) / 2}) rotate(-90)`, "text-anchor": "middle" }, withUnit(y));
  picture.append(side);
  const colours = colouring(known);
  for (const curve of curves(known, x)) {
    const points = curve.map((row) => `${across(valueOf(row, x))},${up(valueOf(row, y))}`).join(" ");
    picture.append(svg("polyline", { points, fill: "none", stroke: colours.of(curve[0]), "stroke-opacity": 0.6 }));
  }
  for (const row of known) {
    const place = { cx: across(valueOf(row, x)), cy: up(valueOf(row, y)), r: known.length > 200 ? 3 : 4.5 };
    const point = svg("circle", { class: "point", "data-number": row.number, fill: colours.of(row), ...place });
    point.append(svg("title", {}, `${row.number}: ${shown(valueOf(row, x))}, ${shown(valueOf(row, y))}`));
    point.addEventListener("mouseenter", () => near(row.number));
    point.addEventListener("mouseleave", () => near(null));
    point.addEventListener("click", () => open(row));
    picture.append(point);
  }
  byId("plot").append(picture);
  for (const [colour, text] of colours.legend) {
    const dot = element("i");
    dot.style.background = colour;
    byId("legend").append(element("span", {}, dot, text));
  }
}
