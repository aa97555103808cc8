"use strict";
// Charts in the place of the drawings, on screens: zoom, read-off, curves to switch, by mouse or keys.

const chartHelp = "Arrow keys left and right move the reading, with Shift ten at a time; up and down " +
  "change the curve; plus and minus zoom; Escape shows all.";
const smallestDrag = 5;  // pixels: less is a click

class Chart {
  /** Builds a chart of `figure` inside `box`, an empty element on the page. */
  constructor(box, figure, description) {
    this.box = box;
    this.figure = figure;
    this.sample = null;  // {curve, index} that is read off
    this.colours = new ChartColours(box);
    this.layOut(description);
    this.plot = this.makePlot();
    this.listen();
  }

  layOut(description) {
    const button = (text, name, action) => {
      const made = makeElement("button", "chart-button", text);
      made.type = "button";
      made.setAttribute("aria-label", `${name}: ${this.figure.title}`);
      made.addEventListener("click", action);
      return made;
    };
    this.area = makeElement("div", "chart-area");
    this.area.tabIndex = 0;
    this.area.setAttribute("role", "application");
    this.area.setAttribute("aria-label", `Chart: ${description}. ${chartHelp}`);
    this.readOff = makeElement("p", "chart-read-off", "Point at the chart to read it off; drag to zoom.");
    this.spoken = makeElement("p", "chart-spoken");
    this.spoken.setAttribute("aria-live", "polite");
    const bar = makeElement("div", "chart-bar",
      button("show all", "Show all", () => this.showAll()),
      button("+", "Zoom in", () => this.zoom(0.5)),
      button("−", "Zoom out", () => this.zoom(2)), this.readOff);
    this.box.append(bar, this.area, makeChartLegend(this), this.spoken);
  }

  size() {
    const width = Math.max(200, Math.floor(this.area.clientWidth));
    const share = this.figure.equalScale ? 0.75 : 0.45;
    return { width, height: Math.round(Math.min(Math.max(width * share, 240), 480)) };
  }

  makePlot() {
    const { series, bands, data, parts } = plotSeries(this.figure, this.colours);
    this.parts = parts;
    const asGiven = { time: false, auto: false, range: (plot, low, high) => [low, high] };
    const whole = wholeView(this.figure);
    return new uPlot({
      ...this.size(), series, bands,
      scales: { x: { ...asGiven, min: whole.x[0], max: whole.x[1] },
                y: { ...asGiven, min: whole.y[0], max: whole.y[1] } },
      axes: [{ ...plotAxis(this.figure.xLabel, this.colours, 36), space: 75 }, plotAxis(this.figure.yLabel, this.colours, 56, this.figure.rows)],
      legend: { show: false },
      cursor: {
        x: false, y: false, points: { show: false },
        drag: { x: true, y: this.figure.equalScale, setScale: false },
        bind: { dblclick: () => () => this.showAll() },
      },
      hooks: {
        ready: [() => this.showAll()],  // only now is it known how large the frame is
        drawClear: [(plot) => drawSpans(plot, this.figure, this.colours)],
        draw: [(plot) => {
          drawMarks(plot, this.figure, this.colours);
          this.placeMarker();
        }],
        setSelect: [(plot) => this.zoomToSelection(plot)],
      },
    }, data, this.area);
  }

  listen() {
    this.marker = makeElement("div", "chart-marker");
    this.marker.hidden = true;
    this.plot.over.append(this.marker);
    this.plot.over.addEventListener("mousemove", (event) => this.onMouse(event));
    this.area.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.resize()).observe(this.area);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
  }

  redraw() {
    this.colours.forget();
    this.plot.redraw(true, true);
  }

  resize() {
    const { width, height } = this.size();
    if (!this.view || width === 0) return;
    if (width === this.plot.width && height === this.plot.height) return;
    this.plot.setSize({ width, height });
    this.show(this.view);
  }

  /** Shows a view {x, y}; on a track it is widened to the same scale on both axes. */
  show(view) {
    this.view = view;
    const { clientWidth, clientHeight } = this.plot.over;
    const fitted = this.figure.equalScale ? equalView(view, clientWidth, clientHeight) : view;
    this.plot.batch(() => {
      this.plot.setScale("x", { min: fitted.x[0], max: fitted.x[1] });
      this.plot.setScale("y", { min: fitted.y[0], max: fitted.y[1] });
    });
    this.box.dataset.range = [...fitted.x, ...fitted.y].join(" ");
  }

  showAll() {
    this.show(wholeView(this.figure));
  }

  /** Shows `share` of what is shown now, around what is read off, else around the middle. */
  zoom(share) {
    const { x, y } = this.plot.scales;
    const at = this.sample && this.sample.curve.x[this.sample.index];
    const up = this.sample && this.sample.curve.y[this.sample.index];
    const around = ({ min, max }, value) => {
      const middle = value !== null && value >= min && value <= max ? value : (min + max) / 2;
      return [middle - share * (middle - min), middle + share * (max - middle)];
    };
    this.showPart({ x: around(x, at), y: around(y, up) });
  }

  /** Shows part of the figure; what would be more than the whole figure is all of it. */
  showPart({ x, y }) {
    const whole = wholeView(this.figure);
    const held = [Math.max(x[0], whole.x[0]), Math.min(x[1], whole.x[1])];
    if (!this.figure.equalScale) {
      const isWhole = held[1] - held[0] >= (1 - 1e-9) * (whole.x[1] - whole.x[0]);
      if (held[1] > held[0]) this.show(isWhole ? whole : viewWithin(this.figure, held));
    } else this.show(x[1] - x[0] >= this.plot.over.clientWidth * this.wholeScale(whole) ? whole : { x, y });
  }

  /** Metres per pixel of the whole track. */
  wholeScale({ x, y }) {
    const { clientWidth, clientHeight } = this.plot.over;
    return Math.max((x[1] - x[0]) / clientWidth, (y[1] - y[0]) / clientHeight);
  }

  zoomToSelection(plot) {
    const { left, top, width, height } = plot.select;
    if (width === 0 && height === 0) return;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    if (width < smallestDrag && height < smallestDrag) return;
    const along = (from, length, scale) => [plot.posToVal(from, scale), plot.posToVal(from + length, scale)]
      .sort((a, b) => a - b);
    this.showPart({ x: along(left, width, "x"), y: along(top, height, "y") });
  }

  placeOf({ curve, index }) {
    return [this.plot.valToPos(curve.x[index], "x"), this.plot.valToPos(curve.y[index], "y")];
  }

  /** Marks the sample that is read off, where it is in view. */
  placeMarker() {
    const [left, top] = this.sample ? this.placeOf(this.sample) : [-1, -1];
    const { clientWidth, clientHeight } = this.plot.over;
    this.marker.hidden = left < 0 || left > clientWidth || top < 0 || top > clientHeight;
    this.marker.style.transform = `translate(${left}px, ${top}px)`;
  }

  readSample(sample) {
    this.sample = sample;
    this.placeMarker();
    this.writeReadOff();
  }

  onMouse(event) {
    const frame = this.plot.over.getBoundingClientRect();
    const found = this.nearestTo(this.figure.curves, event.clientX - frame.left, event.clientY - frame.top);
    if (found) this.readSample(found);
  }

  writeReadOff() {
    const { x } = this.plot.scales;
    const { curve, index } = this.sample;
    this.readOff.textContent = readOffWords(this.figure, curve, index, 0.02 * (x.max - x.min));
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 10 : 1;
    const actions = {
      ArrowLeft: () => this.step(-step), ArrowRight: () => this.step(step),
      ArrowUp: () => this.changeCurve(-1), ArrowDown: () => this.changeCurve(1),
      "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), "−": () => this.zoom(2),
      Escape: () => this.showAll(),
    };
    if (!Object.hasOwn(actions, event.key)) return;
    event.preventDefault();
    actions[event.key]();
    if (!event.key.startsWith("Arrow")) return;
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => { this.spoken.textContent = this.readOff.textContent; }, 200);
  }

  /** The sample of some curves that is nearest to a place on the plot. */
  nearestTo(curves, left, top) {
    return this.figure.equalScale ? nearestOnTrack({ curves }, this.plot, left, top)
      : nearestOnCurve(curves, this.sample, this.plot.posToVal(left, "x"));
  }

  inMiddle() {
    const { clientWidth, clientHeight } = this.plot.over;
    return this.nearestTo(this.figure.curves, clientWidth / 2, clientHeight / 2);
  }

  /** Moves the reading by samples; the view follows. */
  step(count) {
    const fresh = !this.sample || !this.sample.curve.shown;
    const { curve, index } = fresh ? this.inMiddle() || {} : this.sample;
    if (!curve) return;
    this.follow({ curve, index: fresh ? index : samplesFurther(curve, index, count) });
  }

  /** Reads a sample off, and moves the view so that it is in it. */
  follow(sample) {
    const { x, y } = this.plot.scales;
    const { curve, index } = sample;
    const shifted = ({ min, max }, value) => value >= min && value <= max ? [min, max]
      : [value - (max - min) / 2, value + (max - min) / 2];
    const view = { x: shifted(x, curve.x[index]), y: shifted(y, curve.y[index]) };
    if (view.x[0] !== x.min || view.y[0] !== y.min) this.showPart(view);
    this.readSample(sample);
  }

  changeCurve(direction) {
    const curves = this.figure.curves.filter(({ shown, isRead }) => shown && isRead);
    if (!this.sample || curves.length === 0) return this.step(0);
    const next = curves.indexOf(this.sample.curve) + direction;
    const curve = curves[(next + curves.length) % curves.length];
    this.follow(this.nearestTo([curve], ...this.placeOf(this.sample)) || this.sample);
  }

  /** Draws a part of the figure, or leaves it out; the height follows what is drawn. */
  switchPart(part) {
    part.shown = !part.shown;
    const curve = this.figure.curves.indexOf(part);
    const { x, y } = this.plot.scales;
    const view = { x: [x.min, x.max], y: [y.min, y.max] };
    this.plot.batch(() => {
      for (const index of this.parts[curve] || []) this.plot.setSeries(index, { show: part.shown });
      this.showPart(view);
    });
    this.plot.redraw(false);
  }
}

/** Puts a chart in the place of each drawing that can be charted; the others keep their drawing. */
function makeCharts() {
  let figures = [];
  try {
    figures = embeddedReport().predicate.figures || [];
  } catch (error) {
    return;  // the check has said what is wrong
  }
  figures.forEach((figure, index) => {
    const element = document.getElementById(`figure-${index}`);
    const drawing = element && element.querySelector(".drawing");
    const isSmall = element?.parentElement.classList.contains("small");
    if (!drawing || isSmall || !Array.isArray(figure.curves) || figure.curves.length === 0) return;
    const box = makeElement("div", "chart");
    try {
      element.insertBefore(box, drawing);
      element.classList.add("charted");
      box.chart = new Chart(box, readFigure(figure), figure.figure_title);
    } catch (error) {
      box.remove();
      element.classList.remove("charted");
      console.warn(`figure ${index + 1} keeps its drawing: ${error.message}`);
    }
  });
}
