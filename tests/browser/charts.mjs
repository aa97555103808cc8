// Charts in the place of drawings: zoom, read-off, keys, legend, print.
import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";

const run = () => pages.signedRun();
const figures = () => pages.reportOf(run()).predicate.figures;
/** Small ones, on the first page, are to be seen at a glance and stay drawings. */
const isCharted = ({ figure }) => figure !== "place" && figure !== "result";
const indexOf = (found) => {
  const index = figures().findIndex((figure) => isCharted(figure) && found(figure));
  assert.ok(index >= 0, "the report has such a figure");
  return index;
};
const chartOf = (page, index) => page.locator(`#figure-${index} .chart`);
const byTime = () => indexOf((figure) => !figure.equal_scale && figure.curves[0].curve_kind === "line");

/** What a chart shows: {x: [from, to], y: [from, to], box} (box: its frame on the screen, pixels). */
async function viewOf(chart) {
  await chart.scrollIntoViewIfNeeded();
  const [x0, x1, y0, y1] = (await chart.getAttribute("data-range")).split(" ").map(Number);
  return { x: [x0, x1], y: [y0, y1], box: await chart.locator(".u-over").boundingBox() };
}

async function drag(page, { box }, from, to) {
  const at = ([across, down]) => [box.x + across * box.width, box.y + down * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  await page.mouse.move(...at(to), { steps: 8 });
  await page.mouse.up();
}

const near = (value, expected, tolerance, what) =>
  assert.ok(Math.abs(value - expected) <= tolerance, `${what}: ${value}, not ${expected} ± ${tolerance}`);

const readOff = (chart) => chart.locator(".chart-read-off").innerText();
const pictureOf = (chart) => chart.evaluate((box) => box.querySelector("canvas").toDataURL());

describe("charts", () => {
  test("stand in the place of every drawing but the small ones on screen, and not in print", async () => {
    await withPage(pages.pageOf(run()), async (page) => {
      assert.equal(await page.locator(".chart").count(), figures().filter(isCharted).length);
      for (const [index, figure] of figures().entries())
        assert.equal(await page.locator(`#figure-${index} .drawing svg`).isVisible(), !isCharted(figure), figure.figure);
      await page.emulateMedia({ media: "print" });
      assert.equal(await page.locator("#self-check").isVisible(), false, "the printed page is the PDF");
      for (const chart of await page.locator(".chart").all()) assert.equal(await chart.isVisible(), false);
      for (const picture of await page.locator(".drawing svg").all()) assert.ok(await picture.isVisible());
    });
  });

  test("dragging shows the stretch that was dragged over; button and double click show all", async () => {
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, byTime());
      const whole = await viewOf(chart);
      const length = whole.x[1] - whole.x[0];
      await drag(page, whole, [0.25, 0.5], [0.75, 0.5]);
      const part = await viewOf(chart);
      near(part.x[0], whole.x[0] + 0.25 * length, 0.03 * length, "left edge");
      near(part.x[1], whole.x[0] + 0.75 * length, 0.03 * length, "right edge");
      await chart.getByText("show all").click();
      assert.deepEqual((await viewOf(chart)).x, whole.x);
      await drag(page, whole, [0.5, 0.5], [0.6, 0.5]);
      assert.notDeepEqual((await viewOf(chart)).x, whole.x);
      await page.mouse.dblclick(whole.box.x + 30, whole.box.y + 30);
      assert.deepEqual(await viewOf(chart), whole);
    });
  });

  test("read off what stands in the report", async () => {
    const index = byTime();
    const figure = figures()[index];
    const curve = figure.curves.find(({ curve_kind: kind }) => kind !== "points");
    const unit = /\(([^()]*)\)$/.exec(figure.y_label)[1];
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, index);
      const { x, box } = await viewOf(chart);
      const spacing = Math.max(...curve.x.slice(1).map((value, at) => value - curve.x[at]));
      for (const across of [0.1, 0.37, 0.62, 0.9]) {
        await page.mouse.move(box.x + across * box.width, box.y + 0.4 * box.height);
        const words = await readOff(chart);
        const time = parseFloat(words);
        const at = curve.x.indexOf(time);
        assert.ok(at >= 0, `${words}: its time is one of the report`);
        near(time, x[0] + across * (x[1] - x[0]), spacing + 2 * (x[1] - x[0]) / box.width, "the time under the mouse");
        assert.ok(words.includes(`${curve.curve_name} `), words);
        const value = new RegExp(`(-?[\\d.]+(?:e-?\\d+)?) ${unit}`).exec(words)[1];
        assert.equal(Number(value), curve.y[at]);
      }
    });
  });

  test("keys move the reading, zoom and reset, and what is read is announced", async () => {
    const index = byTime();
    const curve = figures()[index].curves[0];
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, index);
      const whole = await viewOf(chart);
      await chart.locator(".chart-area").focus();
      await page.keyboard.press("ArrowRight");
      const first = curve.x.indexOf(parseFloat(await readOff(chart)));
      assert.ok(first >= 0);
      await page.keyboard.press("ArrowRight");
      assert.equal(parseFloat(await readOff(chart)), curve.x[first + 1]);
      await page.keyboard.press("Shift+ArrowLeft");
      const third = await readOff(chart);
      assert.equal(parseFloat(third), curve.x[first - 9]);
      await page.waitForFunction(([box, words]) => box.querySelector("[aria-live=polite]").textContent === words,
        [await chart.elementHandle(), third]);
      await page.keyboard.press("+");
      const part = await viewOf(chart);
      near((part.x[1] - part.x[0]) / (whole.x[1] - whole.x[0]), 0.5, 1e-6, "half of the run");
      assert.ok(part.x[0] <= curve.x[first - 9] && curve.x[first - 9] <= part.x[1], "around the reading");
      await page.keyboard.press("-");
      await page.keyboard.press("Escape");
      assert.deepEqual(await viewOf(chart), whole);
    });
  });

  test("the view follows the reading", async () => {
    const index = byTime();
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, index);
      await chart.locator(".chart-area").focus();
      for (const key of ["ArrowRight", "+", "+", "+", "+", "+"]) await page.keyboard.press(key);
      for (let count = 0; count < 6; ++count) await page.keyboard.press("Shift+ArrowRight");
      const { x } = await viewOf(chart);
      const time = parseFloat(await readOff(chart));
      assert.ok(x[0] <= time && time <= x[1], `${time} within ${x}`);
    });
  });

  test("every entry of the legend switches what it names", async () => {
    await withPage(pages.pageOf(run()), async (page) => {
      for (const chart of await page.locator(".chart").all()) {
        const entries = await chart.locator(".chart-switch").all();
        assert.ok(entries.length > 0);
        await chart.scrollIntoViewIfNeeded();
        const whole = await pictureOf(chart);
        for (const entry of entries) {
          await entry.click();
          assert.equal(await entry.getAttribute("aria-pressed"), "false");
          assert.ok(await pictureOf(chart) !== whole, `${await entry.innerText()} is no longer drawn`);
          await entry.click();
          assert.equal(await entry.getAttribute("aria-pressed"), "true");
          assert.ok(await pictureOf(chart) === whole, `${await entry.innerText()} is drawn again`);
        }
      }
    });
  });

  test("a track has the same metres per pixel on both axes, zoomed or not", async () => {
    const index = indexOf((figure) => figure.equal_scale);
    const figure = figures()[index];
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, index);
      const expectEqual = ({ x, y, box }) =>
        near((x[1] - x[0]) / box.width * box.height / (y[1] - y[0]), 1, 0.005, "metres per pixel, east to north");
      const whole = await viewOf(chart);
      expectEqual(whole);
      for (const [list, [low, high]] of [["x", whole.x], ["y", whole.y]])
        for (const curve of figure.curves)
          for (const value of curve[list]) assert.ok(value === null || (low <= value && value <= high), "all of it is seen");
      await drag(page, whole, [0.4, 0.4], [0.6, 0.5]);
      const part = await viewOf(chart);
      expectEqual(part);
      near((part.x[1] - part.x[0]) / (whole.x[1] - whole.x[0]), 0.2, 0.02, "a fifth of the whole");
      await chart.locator(".chart-area").focus();
      await page.keyboard.press("Escape");
      await page.keyboard.press("ArrowRight");
      const [east, north] = (await readOff(chart)).match(/-?\d+(\.\d+)?(?= m\b)/g).map(Number);
      assert.ok(figure.curves.some(({ x, y }) => x.some((value, at) => value === east && y[at] === north)),
        `${east}, ${north} is a point of the report`);
    });
  });

  test("a chart that fails leaves its drawing", async () => {
    const before = "Object.defineProperty(window, 'uPlot', { set() {}, get() { throw new Error('no canvas'); } });";
    await withPage(pages.pageOf(run()), async (page) => {
      assert.equal(await page.locator(".chart").count(), 0);
      for (const picture of await page.locator(".drawing svg").all()) assert.ok(await picture.isVisible());
    }, { before });
  });

  test("follow the window's width and the dark mode", async () => {
    await withPage(pages.pageOf(run()), async (page) => {
      const chart = chartOf(page, byTime());
      const light = await pictureOf(chart);
      await page.emulateMedia({ colorScheme: "dark" });
      await page.waitForFunction(([box, was]) => box.querySelector("canvas").toDataURL() !== was,
        [await chart.elementHandle(), light]);
      await page.setViewportSize({ width: 360, height: 700 });
      await page.waitForFunction((box) => box.querySelector(".uplot").offsetWidth <= box.clientWidth, await chart.elementHandle());
      const box = await chart.boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 360);
    });
  });
});
