"use strict";
// The figures of report.json as numbers, with the text in which each number was signed.

/** What stands in brackets at the end of an axis' label: its unit, "" where it has none. */
const unitOf = (label) => (/\(([^()]+)\)\s*$/.exec(label || "") || ["", ""])[1];

/** What stands before a comma in a part's name: the legend has each kind once ("window, nalsa"). */
const kindOf = (name) => name.split(", ", 1)[0];

/** A number as it was written in the report; null stays null. */
const numberOf = (written) => written === null || written === undefined ? null : Number(written);

/**
 * One curve: x, y, lower, upper as numbers (null where a line breaks), `written` the same as texts.
 * Curves over an axis run from left to right; a track keeps the order in which it was driven.
 */
function readCurve(curve, keepOrder) {
  const order = curve.x.map((value, index) => index);
  if (!keepOrder) order.sort((a, b) => Number(curve.x[a]) - Number(curve.x[b]) || a - b);
  const written = {};
  for (const name of ["x", "y", "lower", "upper"])
    if (Array.isArray(curve[name])) written[name] = order.map((index) => curve[name][index]);
  const numbers = {};
  for (const [name, texts] of Object.entries(written)) numbers[name] = texts.map(numberOf);
  return {
    name: curve.curve_name, kind: curve.curve_kind, colour: curve.colour, shown: true,
    hasBand: Boolean(numbers.lower && numbers.upper), isRead: curve.curve_kind !== "outline", written, ...numbers,
  };
}

/** A figure of the report, ready to be drawn. `shown` of each part is what the legend switches. */
function readFigure(figure) {
  const named = (list, name) => (list || []).map((part) => ({ ...part, name: part[name], shown: true }));
  return {
    title: figure.figure_title,
    xLabel: figure.x_label, yLabel: figure.y_label,
    xUnit: unitOf(figure.x_label), yUnit: unitOf(figure.y_label),
    equalScale: figure.equal_scale === true,
    rows: (figure.rows || []).map((row) => ({ name: row.row_name, y: Number(row.y) })),
    bounds: ["x_min", "x_max", "y_min", "y_max"].map((name) => numberOf(figure[name])),
    curves: figure.curves.map((curve) => readCurve(curve, figure.equal_scale === true)),
    levels: named(figure.levels, "level_name").map((part) => ({ ...part, level: Number(part.level) })),
    spans: named(figure.spans, "span_name")
      .map((part) => ({ ...part, from: Number(part.from), to: Number(part.to) })),
    marks: named(figure.marks, "mark_name")
      .map((part) => ({ ...part, x: Number(part.x), y: Number(part.y) })),
  };
}

/** The smallest and largest of some lists of numbers; null and NaN do not count. */
function extentOf(...lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists)
    for (const value of list)
      if (value !== null && Number.isFinite(value)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
  return low <= high ? [low, high] : [0, 1];
}

/** An extent with room at both ends; one point gets room too. */
function withRoom([low, high], share) {
  const room = high > low ? share * (high - low) : Math.max(1e-3 * Math.abs(low), 1e-6);
  return [low - room, high + room];
}

/** The y values that a view from `from` to `to` shows of the curves that are switched on. */
function heightsWithin(figure, from, to) {
  const heights = [];
  for (const curve of figure.curves.filter(({ shown }) => shown))
    for (const values of [curve.y, curve.lower || [], curve.upper || []])
      values.forEach((value, index) => {
        if (value !== null && curve.x[index] >= from && curve.x[index] <= to) heights.push(value);
      });
  return heights;
}

/** The view of the whole figure, {x: [from, to], y: [from, to]}. */
function wholeView({ bounds: [left, right, bottom, top] }) {
  return { x: [left, right], y: [bottom, top] };
}

/** A view of part of a run: the height follows what is drawn there. */
function viewWithin(figure, x) {
  return { x, y: withRoom(extentOf(heightsWithin(figure, ...x)), 0.05) };
}

/** A view with the same metres per pixel on both axes that shows all of another. */
function equalView({ x, y }, width, height) {
  const scale = Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
  const around = ([low, high], pixels) => {
    const middle = (low + high) / 2;
    return [middle - scale * pixels / 2, middle + scale * pixels / 2];
  };
  return { x: around(x, width), y: around(y, height) };
}

/** The index of the value nearest to `wanted` among ascending x whose y is not null; -1 for none. */
function nearestSample(curve, wanted) {
  let [low, high] = [0, curve.x.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (curve.x[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  let [left, right] = [low - 1, low];
  while (left >= 0 && curve.y[left] === null) --left;
  while (right < curve.x.length && curve.y[right] === null) ++right;
  if (left < 0) return right < curve.x.length ? right : -1;
  if (right >= curve.x.length) return left;
  return wanted - curve.x[left] <= curve.x[right] - wanted ? left : right;
}

/** One sample in words: the values as they stand in the report, with units. */
function sampleWords(figure, curve, index) {
  const withUnit = (text, unit) => unit ? `${text} ${unit}` : text;
  const value = withUnit(curve.written.y[index], figure.yUnit);
  const band = curve.hasBand && curve.lower[index] !== null && curve.upper[index] !== null
    ? ` (${curve.written.lower[index]} to ${curve.written.upper[index]})` : "";
  return { at: withUnit(curve.written.x[index], figure.xUnit), value: value + band };
}

/** The read-off at a sample, in words: its curve first, then the others near it. */
function readOffWords(figure, main, index, reach) {
  const own = sampleWords(figure, main, index);
  if (figure.equalScale) return `${main.name}: ${figure.xLabel} ${own.at}, ${figure.yLabel} ${own.value}`;
  const words = [`${own.at}: ${main.name} ${own.value}`];
  for (const curve of figure.curves) {
    if (curve === main || !curve.shown || !curve.isRead) continue;
    const other = nearestSample(curve, main.x[index]);
    if (other < 0 || Math.abs(curve.x[other] - main.x[index]) > reach) continue;
    const { at, value } = sampleWords(figure, curve, other);
    words.push(`${curve.name} ${value}${at === own.at ? "" : ` at ${at}`}`);
  }
  return words.join("; ");
}
