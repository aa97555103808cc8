// axe-core and the width of a phone, for every kind of page in every dress.
import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { violationsOf, withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";

const kinds = {
  signed: () => pages.pageOf(pages.signedRun()),
  rejected: () => pages.pageOf(pages.rejectedRun()),
  unsigned: () => pages.pageOf(pages.unsignedRun()),
  hostile: () => pages.pageOf(pages.hostileRun()),
  tampered: () => pages.editedPage(pages.signedRun(), "tampered", (text) =>
    pages.changeMain(text, (main) => main.replace("measurer", "director"))),
};
const phone = { viewport: { width: 360, height: 740 } };
const dresses = {
  light: { colorScheme: "light" },
  dark: { colorScheme: "dark" },
  "phone, light": { colorScheme: "light", ...phone },
  "phone, dark": { colorScheme: "dark", ...phone },
};

describe("every page can be used", () => {
  for (const [kind, file] of Object.entries(kinds))
    for (const [dress, options] of Object.entries(dresses))
      test(`${kind}, ${dress}: axe-core finds nothing, nothing is wider than the screen`, async () => {
        await withPage(file(), async (page) => {
          assert.deepEqual(await violationsOf(page), []);
          const [whole, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
          assert.ok(whole <= screen, `${whole} pixels on a screen of ${screen}`);
        }, options);
      });
});
