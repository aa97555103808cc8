// axe-core and the width of a phone, for every kind of page in every dress.
import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { violationsOf, withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";
import { isStudy } from "./programs.mjs";

const kinds = {
  signed: () => pages.pageOf(pages.signedRun()),
  rejected: () => pages.pageOf(pages.rejectedRun()),
  unsigned: () => pages.pageOf(pages.unsignedRun()),
  hostile: () => pages.pageOf(pages.hostileRun()),
  tampered: () => pages.editedPage(pages.signedRun(), "tampered", (text) =>
    pages.changePart(text, "report-json", (json) => json + " ")),
};
const phone = { viewport: { width: 360, height: 740 } };
const dresses = {
  light: { colorScheme: "light" },
  dark: { colorScheme: "dark" },
  "phone, light": { colorScheme: "light", ...phone },
  "phone, dark": { colorScheme: "dark", ...phone },
};

// Daily each kind in one dress, and the signed page, which has all parts, in every one: a colour that
// is too pale in the dark or a table that is too wide for a phone is the style sheet's, and so any page's.
const isDaily = (kind, dress) => kind === "signed" || dress === { rejected: "phone, dark", unsigned: "light",
  hostile: "phone, light", tampered: "dark" }[kind];

describe("every page can be used", () => {
  for (const [kind, file] of Object.entries(kinds))
    for (const [dress, options] of Object.entries(dresses).filter(([dress]) => isStudy || isDaily(kind, dress)))
      test(`${kind}, ${dress}: axe-core finds nothing, nothing is wider than the screen`, async () => {
        await withPage(file(), async (page) => {
          assert.deepEqual(await violationsOf(page), []);
          const [whole, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
          assert.ok(whole <= screen, `${whole} pixels on a screen of ${screen}`);
        }, options);
      });
});
