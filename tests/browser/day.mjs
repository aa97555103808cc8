// The page of a day's results: its tables sort under its own policy, and it can be used everywhere.
import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { violationsOf, withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";

const dressed = (options) => ({ checking: false, ...options });
const phone = { viewport: { width: 360, height: 740 } };

describe("the page of a day", () => {
  test("rows sort with what stands beneath them, and back", async () => {
    await withPage(pages.dayPage(), async (page) => {
      const table = page.locator("#failures table");
      const rows = () => table.locator("tbody").allTextContents();
      const before = await rows();
      assert.equal(before.length, 12);
      const button = table.locator("thead button").first();
      await button.click();
      const up = await rows();
      await button.click();
      assert.notDeepEqual(await rows(), up);
      assert.deepEqual([...up].sort(), [...before].sort());
      await button.click();
      assert.deepEqual(await rows(), before);
    }, dressed());
  });

  test("a table of one row does not sort", async () => {
    await withPage(pages.dayPage(), async (page) => {
      for (const table of await page.locator("main table").all())
        assert.equal(await table.locator("thead button").count() > 0, await table.locator("tbody").count() > 1);
    }, dressed());
  });

  test("it leads to the reports, and nowhere else", async () => {
    await withPage(pages.dayPage(), async (page) => {
      const links = await page.locator("main a").evaluateAll((all) => all.map((a) => a.getAttribute("href")));
      assert.ok(links.some((link) => link.endsWith("/report.html")));
      for (const link of links) assert.match(link, /^[\w%~.-]+(\/[\w%~.-]+)*$/);
    }, dressed());
  });

  test("the required speed can be seen", async () => {
    await withPage(pages.dayPage(), async (page) => {
      const drawing = page.locator(".drawing svg").first();
      assert.match(await drawing.textContent(), /required speed/);
      const strokes = await drawing.locator("path").evaluateAll((lines) =>
        lines.map((line) => getComputedStyle(line).stroke));
      assert.ok(strokes.length > 0);
      for (const stroke of strokes) assert.match(stroke, /^rgb\(/);
    }, dressed());
  });

  for (const [name, options] of Object.entries({
    light: { colorScheme: "light" }, dark: { colorScheme: "dark" },
    "phone, light": { colorScheme: "light", ...phone }, "phone, dark": { colorScheme: "dark", ...phone },
  }))
    test(`${name}: axe-core finds nothing, nothing is wider than the screen`, async () => {
      await withPage(pages.dayPage(), async (page) => {
        assert.deepEqual(await violationsOf(page), []);
        const [whole, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
        assert.ok(whole <= screen, `${whole} pixels on a screen of ${screen}`);
      }, dressed(options));
    });
});
