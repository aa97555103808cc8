"use strict";
// What a chart is asked: which sample is near, and which of its parts are drawn.

/**
 * The sample nearest in x on the curve that was read off last, where it is one of those drawn, else
 * on the first line. Null where nothing is drawn.
 */
function nearestOnCurve(curves, last, x) {
  const shown = curves.filter((curve) => curve.shown && curve.isRead);
  const curve = last && shown.includes(last.curve) ? last.curve
    : shown.find(({ kind }) => kind !== "points") || shown[0];
  const index = curve ? nearestSample(curve, x) : -1;
  return index < 0 ? null : { curve, index };
}

/** The sample of a track nearest to a place on the plot, in pixels. */
function nearestOnTrack({ curves }, plot, left, top) {
  let found = null;
  let smallest = Infinity;
  for (const curve of curves.filter(({ shown, isRead }) => shown && isRead))
    curve.x.forEach((x, index) => {
      if (curve.y[index] === null) return;
      const distance = Math.hypot(plot.valToPos(x, "x") - left, plot.valToPos(curve.y[index], "y") - top);
      if (distance < smallest) [smallest, found] = [distance, { curve, index }];
    });
  return found;
}

/** The index `count` samples further along a curve, as far as it goes; gaps are not counted. */
function samplesFurther(curve, index, count) {
  const step = Math.sign(count);
  for (let left = Math.abs(count); left > 0; --left) {
    let next = index + step;
    while (next >= 0 && next < curve.x.length && curve.y[next] === null) next += step;
    if (next < 0 || next >= curve.x.length) return index;
    index = next;
  }
  return index;
}

/** Buttons that switch curves, levels, spans and marks; parts of one kind are one button. */
function makeChartLegend(chart) {
  const { curves, levels, spans, marks } = chart.figure;
  const list = makeElement("ul", "chart-legend");
  const add = (parts, sign, colour) => {
    const names = new Map();
    for (const part of parts.filter(({ name }) => name))
      names.set(kindOf(part.name), [...(names.get(kindOf(part.name)) || []), part]);
    for (const [name, same] of names) {
      const swatch = makeElement("span", `chart-swatch chart-swatch-${sign(same[0])}`);
      swatch.style.color = `var(--chart-${colour(same[0])})`;
      swatch.setAttribute("aria-hidden", "true");
      const button = makeElement("button", "chart-switch", swatch, name);
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      button.addEventListener("click", () => {
        same.forEach((part) => chart.switchPart(part));
        button.setAttribute("aria-pressed", String(same[0].shown));
      });
      list.append(makeElement("li", "", button));
    }
  };
  add(curves, ({ kind }) => kind, ({ colour }) => colour);
  add(levels, () => "dashed", () => "vermilion");
  add(spans, ({ span_kind: kind }) => `span-${kind}`, ({ span_kind: kind }) => spanColours[kind] || "grey");
  add(marks, () => "mark", () => "vermilion");
  list.setAttribute("aria-label", `Parts of the chart: ${chart.figure.title}`);
  return list;
}
