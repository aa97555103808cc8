"use strict";
// Tables that sort: the header cells of table.sortable become buttons.

const sortCollator = new Intl.Collator("en", { numeric: true });
const unitFactors = { mm: 1e-3, cm: 1e-2, m: 1, km: 1e3, ns: 1e-9, µs: 1e-6, ms: 1e-3, s: 1, min: 60, h: 3600 };

/** The number with which a cell begins, in the base unit where its unit has one; NaN where none. */
function leadingNumber(text) {
  if (text.startsWith("∞")) return Infinity;
  const form = /^[<>≤≥≈~]?\s*([+\-−]?\d[\d\u00a0\u2009\u202f]*(?:\.\d+)?(?:[eE][+-]?\d+)?)(?![\d.:/T-])\s*(?:±\s*[\d.]+\s*)?(\S*)/;
  const match = form.exec(text);
  if (!match) return NaN;
  const number = Number(match[1].replace("−", "-").replace(/[\u00a0\u2009\u202f]/g, ""));
  return number * (Object.hasOwn(unitFactors, match[2]) ? unitFactors[match[2]] : 1);
}

/** The text of a row's cell in a column; cells may span several. */
const cellText = (row, column) =>
  Array.from(row.cells).flatMap((cell) => Array(cell.colSpan).fill(cell))[column]?.textContent.trim() ?? "";

/** Compares cells: numbers where the whole column has them, else texts; empty ones come last. */
function cellOrder(texts) {
  const isEmpty = (text) => ["", "-", "–", "—"].includes(text);
  const full = texts.filter((text) => !isEmpty(text));
  const numeric = full.length > 0 && full.every((text) => !Number.isNaN(leadingNumber(text)));
  return (a, b, direction) => {
    if (isEmpty(a) || isEmpty(b)) return Number(isEmpty(a)) - Number(isEmpty(b));
    return direction * (numeric ? leadingNumber(a) - leadingNumber(b) : sortCollator.compare(a, b));
  };
}

/** What moves as one: the bodies of a table where it has several, else its rows. */
function sortableUnits(table) {
  const bodies = Array.from(table.tBodies);
  const units = bodies.length > 1 || bodies[0]?.rows[1]?.classList.contains("further")
    ? bodies.map((body) => ({ node: body, row: body.rows[0] }))
    : Array.from(bodies[0] ? bodies[0].rows : []).map((row) => ({ node: row, row }));
  return units.filter(({ node, row }) => row && !node.classList.contains("mark-total"));
}

/** Puts what moves of a table in order; `direction` 0 gives the order in which they stood at first. */
function sortTable(units, column, direction) {
  const texts = units.map(({ row }) => cellText(row, column));
  const compare = cellOrder(texts);
  const order = units.map((unit, index) => index);
  if (direction !== 0)
    order.sort((a, b) => compare(texts[a], texts[b], direction) || a - b);
  const holder = units[0].node.parentNode;
  const moving = units.map(({ node }) => node);
  // Totals stay below what they sum.
  const total = Array.from(holder.children)
    .find((node) => node.localName === moving[0].localName && !moving.includes(node)) || null;
  for (const index of order) holder.insertBefore(units[index].node, total);
}

function makeSortable(table) {
  const header = table.tHead?.rows[table.tHead.rows.length - 1];
  const units = sortableUnits(table);
  if (!header || units.length < 2) return;
  const headings = Array.from(header.cells);
  const sorted = { heading: null, direction: 0 };
  const sortBy = (heading, column) => {
    const next = sorted.heading !== heading ? 1 : { 0: 1, 1: -1, "-1": 0 }[sorted.direction];
    Object.assign(sorted, { heading, direction: next });
    sortTable(units, column, next);
    for (const other of headings) other.removeAttribute("aria-sort");
    if (next !== 0) heading.setAttribute("aria-sort", next > 0 ? "ascending" : "descending");
  };
  let column = 0;
  for (const heading of headings) {
    const own = column;
    column += heading.colSpan;
    if (heading.textContent.trim() === "") continue;
    const sign = makeElement("span", "sort-sign");
    sign.setAttribute("aria-hidden", "true");
    const button = makeElement("button", "sort-button", ...heading.childNodes, sign);
    button.type = "button";
    button.addEventListener("click", () => sortBy(heading, own));
    heading.append(button);
  }
}

/** Makes every table.sortable sort. A table without header, or with one row, stays as it is. */
function makeTablesSortable() {
  document.querySelectorAll("main#report table.sortable").forEach(makeSortable);
}
