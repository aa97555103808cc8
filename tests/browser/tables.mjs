// Tables that sort.
import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";

/** The texts of a table's body, row by row, and how its heads are marked. */
const stateOf = (table) => table.evaluate((element) => ({
  rows: Array.from(element.tBodies).flatMap((body) => Array.from(body.rows, (row) =>
    Array.from(row.cells, (cell) => cell.textContent.trim()))),
  classes: Array.from(element.tBodies, (body) => body.className),
  bodies: element.tBodies.length,
  sorts: Array.from(element.tHead.rows[0].cells, (head) => head.getAttribute("aria-sort")),
}));

/** As a click does, without waiting for the page to be still: of some hundred, one by one. */
const click = (button) => button.evaluate((element) => element.click());

const sortableTables = (page) => page.locator("main table.sortable:has(thead button):visible");

/** A table of its own in a page's place, made to sort by the page's script. */
async function sortColumn(cells) {
  return withPage(pages.pageOf(pages.signedRun()), async (page) => {
    await page.evaluate((texts) => {
      const rows = texts.map((text) => `<tr><td>${text}</td></tr>`).join("");
      document.querySelector("main").innerHTML =
        `<table class="sortable"><thead><tr><th>Figure</th></tr></thead><tbody>${rows}</tbody></table>`;
      makeTablesSortable();
    }, cells);
    const table = page.locator("main table");
    const orders = [];
    for (let turn = 0; turn < 3; ++turn) {
      await click(table.locator("thead button"));
      orders.push((await stateOf(table)).rows.map(([text]) => text));
    }
    return orders;
  });
}

describe("tables", () => {
  test("sort by a click, the other way by a second, back by a third", async () => {
    await withPage(pages.pageOf(pages.signedRun()), async (page) => {
      const tables = await sortableTables(page).all();
      assert.ok(tables.length > 0, "the report has tables that sort");
      let moved = 0;
      for (const table of tables) {
        const before = await stateOf(table);
        for (const button of await table.locator("thead button").all()) {
          const column = await button.evaluate((element) => element.closest("th").cellIndex);
          await click(button);
          const up = await stateOf(table);
          assert.equal(up.sorts[column], "ascending");
          await click(button);
          const down = await stateOf(table);
          assert.equal(down.sorts[column], "descending");
          if (JSON.stringify(up.rows) !== JSON.stringify(down.rows)) ++moved;
          assert.deepEqual([...up.rows].map(String).sort(), [...before.rows].map(String).sort(), "no row is lost");
          await click(button);
          assert.deepEqual(await stateOf(table), before);
        }
      }
      assert.ok(moved > 0, "something was sorted");
    });
  });

  test("rows that belong together stay together, and totals stay below", async () => {
    let totals = 0;
    await withPage(pages.pageOf(pages.signedRun()), async (page) => {
      for (const table of await sortableTables(page).all()) {
        const before = await stateOf(table);
        if (before.bodies < 2) continue;
        const groupsOf = () => table.evaluate((element) => Array.from(element.tBodies, (body) => body.textContent.trim()).sort());
        const groups = await groupsOf();
        for (const button of await table.locator("thead button").all()) {
          await click(button);
          assert.deepEqual(await groupsOf(), groups);
          const { classes } = await stateOf(table);
          const firstTotal = classes.findIndex((name) => name.includes("total"));
          if (firstTotal >= 0) ++totals;
          if (firstTotal >= 0) assert.ok(classes.slice(firstTotal).every((name) => name.includes("total")));
        }
      }
    });
    assert.ok(totals > 0, "there was a table with totals");
  });

  test("numbers as numbers, with units and ±", async () => {
    const [up, down, back] = await sortColumn(["10.5 m", "9 m", "", "900 mm", "−2.5 ± 0.1 m", "1e3 m", "2 km"]);
    assert.deepEqual(up, ["−2.5 ± 0.1 m", "900 mm", "9 m", "10.5 m", "1e3 m", "2 km", ""]);
    assert.deepEqual(down, ["2 km", "1e3 m", "10.5 m", "9 m", "900 mm", "−2.5 ± 0.1 m", ""]);
    const [degrees] = await sortColumn(["∞", "271", "> 10000", "30"]);
    assert.deepEqual(degrees, ["30", "271", "> 10000", "∞"]);
    const [speeds] = await sortColumn(["900 m/s", "1000 mm/s", "2 km/h"]);
    assert.deepEqual(speeds, ["2 km/h", "900 m/s", "1000 mm/s"], "units of speed are not those of length");
    assert.deepEqual(back, ["10.5 m", "9 m", "", "900 mm", "−2.5 ± 0.1 m", "1e3 m", "2 km"]);
  });

  test("other texts as texts, equal ones in the order in which they stood", async () => {
    const [up] = await sortColumn(["epoch 10", "epoch 9", "2026-03-14", "10 m"]);
    assert.deepEqual(up, ["10 m", "2026-03-14", "epoch 9", "epoch 10"]);
    const [, down] = await sortColumn(["1 m", "1.0 m", "2 m", "1.00 m"]);
    assert.deepEqual(down, ["2 m", "1 m", "1.0 m", "1.00 m"]);
  });

  test("sort by keys", async () => {
    await withPage(pages.pageOf(pages.signedRun()), async (page) => {
      const table = sortableTables(page).first();
      await table.locator("thead button").first().focus();
      await page.keyboard.press("Enter");
      assert.ok((await stateOf(table)).sorts.includes("ascending"));
    });
  });
});
