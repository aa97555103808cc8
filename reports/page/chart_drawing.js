"use strict";
// How a figure is drawn: curves by uPlot, and what it does not know (spans, levels, marks).

/** The colours of the style sheet, as they are now (light or dark). */
class ChartColours {
  constructor(element) {
    this.element = element;
    this.forget();
  }
  forget() {
    this.known = new Map();
  }
  of(name) {
    if (!this.known.has(name))
      this.known.set(name, getComputedStyle(this.element).getPropertyValue(`--chart-${name}`).trim() || "#777");
    return this.known.get(name);
  }
}

const spanColours = { window: "sky", refused: "orange", unusable: "grey", gap: "grey" };
const curveWidths = { thin: 0.9, outline: 2 };
const levelDashes = [[8, 5], [3, 4], [12, 4, 3, 4], [16, 6]];

/** Strokes the points of a track in the order in which they were driven, or dots at them. */
function trackPath(curve) {
  return (plot) => {
    const path = new Path2D();
    let drawing = false;
    curve.x.forEach((x, index) => {
      if (curve.y[index] === null) {
        drawing = false;
        return;
      }
      const at = [plot.valToPos(x, "x", true), plot.valToPos(curve.y[index], "y", true)];
      if (curve.kind === "points") {
        path.moveTo(at[0] + 2 * devicePixelRatio, at[1]);
        path.arc(...at, 2 * devicePixelRatio, 0, 2 * Math.PI);
      } else if (drawing) path.lineTo(...at);
      else path.moveTo(...at);
      drawing = true;
    });
    return { stroke: path, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  };
}

/** uPlot's series, bands and data of a figure; `parts[i]` are the series of curve i. */
function plotSeries(figure, colours) {
  const series = [{}];
  const bands = [];
  const tables = [];
  const parts = figure.curves.map((curve) => {
    const stroke = () => colours.of(curve.colour);
    const main = { label: curve.name, stroke, width: curveWidths[curve.kind] || 1.8, points: { show: false } };
    if (curve.kind === "dashed") main.dash = [7, 5];
    if (figure.equalScale) main.paths = trackPath(curve);
    else if (curve.kind === "points")
      Object.assign(main, { paths: () => null, points: { show: true, size: 4, fill: stroke, width: 1 } });
    const own = [series.push(main) - 1];
    const columns = [curve.y];
    if (curve.hasBand && !figure.equalScale) {
      for (const edge of [curve.lower, curve.upper]) {
        own.push(series.push({ stroke: "transparent", width: 0, points: { show: false } }) - 1);
        columns.push(edge);
      }
      bands.push({ series: [own[2], own[1]], fill: () => colours.of(`${curve.colour}-band`) });
    }
    tables.push([curve.x, ...columns]);
    return own;
  });
  // A track has no x that runs from left to right: its paths bring their own points.
  const data = figure.equalScale ? [[0, 1], ...figure.curves.map(() => [null, null])]
    : uPlot.join(tables);
  return { series, bands, data, parts };
}

/** Runs a drawing inside the plot's frame, with the canvas as it was before afterwards. */
function insideFrame(plot, draw) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(ctx, bbox);
  ctx.restore();
}

/** Shaded stretches of x, below the curves. Their edges are lines, so that thin ones are seen. */
function drawSpans(plot, figure, colours) {
  insideFrame(plot, (ctx, bbox) => {
    for (const span of figure.spans.filter(({ shown }) => shown)) {
      const colour = spanColours[span.span_kind] || "grey";
      const left = plot.valToPos(span.from, "x", true);
      const right = Math.max(plot.valToPos(span.to, "x", true), left + devicePixelRatio);
      ctx.fillStyle = colours.of(`${colour}-span`);
      ctx.fillRect(left, bbox.top, right - left, bbox.height);
      if (span.span_kind === "unusable") continue;
      ctx.strokeStyle = colours.of(colour);
      ctx.lineWidth = devicePixelRatio;
      ctx.setLineDash(span.span_kind === "refused" ? [4 * devicePixelRatio, 3 * devicePixelRatio] : []);
      ctx.strokeRect(left, bbox.top - 9, right - left, bbox.height + 18);
    }
  });
}

function drawLevels(ctx, bbox, plot, figure, colours) {
  figure.levels.forEach(({ level, shown }, index) => {
    if (!shown) return;
    const y = plot.valToPos(level, "y", true);
    ctx.beginPath();
    ctx.setLineDash(levelDashes[index % levelDashes.length].map((length) => length * devicePixelRatio));
    ctx.strokeStyle = colours.of("vermilion");
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  });
  ctx.setLineDash([]);
}

function drawLabel(ctx, bbox, text, x, y) {
  const width = ctx.measureText(text).width;
  const left = Math.min(Math.max(x, bbox.left + 2), bbox.left + bbox.width - width - 2);
  ctx.strokeText(text, left, y);
  ctx.fillText(text, left, y);
}

/** Levels and marks with their names, above the curves. */
function drawMarks(plot, figure, colours) {
  insideFrame(plot, (ctx, bbox) => {
    const pixel = devicePixelRatio;
    drawLevels(ctx, bbox, plot, figure, colours);
    ctx.font = `${12 * pixel}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "alphabetic";
    ctx.lineJoin = "round";
    const label = (text, x, y) => {
      ctx.strokeStyle = colours.of("paper");
      ctx.lineWidth = 3 * pixel;
      ctx.fillStyle = colours.of("ink");
      drawLabel(ctx, bbox, text, x, y);
    };
    for (const { name, level } of figure.levels.filter(({ shown }) => shown))
      label(name, bbox.left + bbox.width, plot.valToPos(level, "y", true) - 4 * pixel);
    for (const mark of figure.marks.filter(({ shown }) => shown)) {
      const [x, y] = [plot.valToPos(mark.x, "x", true), plot.valToPos(mark.y, "y", true)];
      ctx.beginPath();
      for (const [dx, dy] of [[0, -5], [5, 0], [0, 5], [-5, 0]]) ctx.lineTo(x + dx * pixel, y + dy * pixel);
      ctx.closePath();
      ctx.fillStyle = colours.of("vermilion");
      ctx.fill();
      label(mark.name, x + 8 * pixel, y - 6 * pixel);
    }
  });
}

/** Axis numbers with as many decimals as the grid needs, a point for the decimals everywhere. */
function axisNumbers(plot, splits, axis, space, increment) {
  const decimals = Math.min(12, Math.max(0, -Math.floor(Math.log10(increment) + 1e-9)));
  const needed = Number(increment.toFixed(decimals)) === increment ? decimals : decimals + 1;
  return splits.map((value) => value.toFixed(needed).replace(/^-(0(\.0*)?)$/, "$1").replace("-", "−"));
}

/** An axis of a chart in the colours of the page; `rows` name places of it in place of numbers. */
function plotAxis(label, colours, size, rows = []) {
  const named = { splits: () => rows.map(({ y }) => y), values: () => rows.map(({ name }) => name) };
  return {
    label, size, labelSize: 20, labelFont: "13px system-ui, sans-serif", font: "12px system-ui, sans-serif",
    stroke: () => colours.of("ink"),
    grid: { stroke: () => colours.of("grid"), width: 1 },
    ticks: { stroke: () => colours.of("grid"), width: 1 },
    values: axisNumbers,
    ...(rows.length > 0 ? named : {}),
  };
}
