// The table of the sweep, its columns, and what is shown of it.
const sweep = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);

// a chip filters a parameter of at most so many values; others have a range
const MAX_CHIPS = 12;

const columns = [
  ...sweep.parameters.map((each) => ({ ...each, key: `p:${each.path}`, label: each.path, unit: "", isParameter: true })),
  ...sweep.columns.map((each) => ({ ...each, key: `v:${each.name}`, isParameter: false })),
];

function valueOf(row, column) {
  if (column.isParameter) return row.parameters[column.path] ?? null;
  return row.results === null ? null : (row.results[column.name] ?? null);
}

const isNumber = (value) => typeof value === "number";
const isNumeric = (column) => sweep.rows.every((row) => valueOf(row, column) === null || isNumber(valueOf(row, column)));
const isKnown = (column) => sweep.rows.some((row) => valueOf(row, column) !== null);
const numeric = columns.filter((column) => isKnown(column) && isNumeric(column));

function shown(value) {
  if (value === null || value === undefined) return "–";
  if (value === true) return "yes";
  if (value === false) return "no";
  if (isNumber(value)) return String(Number(value.toPrecision(4)));
  return typeof value === "string" ? value : JSON.stringify(value);
}

const withUnit = (column) => (column.unit ? `${column.label}, ${column.unit}` : column.label);

// a path breaks after its dots, not inside of a key
const breakable = (text) => text.split(/(?<=\.)(?=\S)/).flatMap((part, k) => (k ? [element("wbr"), part] : [part]));

const state = {
  sort: "number",
  isDescending: false,
  isOneScale: true,
  view: "cards",
  x: null,
  y: null,
  colour: "",
  chosen: {}, // by column: the texts of the values that pass
  ranges: {}, // by column: [smallest, largest], null for no limit
  hidesFailed: false,
};

function passes(row) {
  if (state.hidesFailed && (row.problem !== null || row.results.is_minimum === false)) return false;
  return columns.every((column) => {
    const value = valueOf(row, column);
    const chosen = state.chosen[column.key];
    if (chosen && chosen.size && !chosen.has(shown(value))) return false;
    const [low, high] = state.ranges[column.key] ?? [null, null];
    if (low === null && high === null) return true;
    return isNumber(value) && (low === null || value >= low) && (high === null || value <= high);
  });
}

function sorted() {
  const column = columns.find((each) => each.key === state.sort);
  const key = (row) => (column ? valueOf(row, column) : row.number);
  const sign = state.isDescending ? -1 : 1;
  return sweep.rows.filter(passes).sort((a, b) => {
    const [one, other] = [key(a), key(b)];
    if (one === null || other === null) return (one === null) - (other === null) || a.number - b.number; // last
    if (isNumber(one) && isNumber(other)) return sign * (one - other) || a.number - b.number;
    return sign * shown(one).localeCompare(shown(other)) || a.number - b.number;
  });
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}
