// Pages in Chromium, from disk, without network. Whatever goes wrong unasked fails the test.
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import { axeSource, chromium, chromiumPath } from "./programs.mjs";

let browser = null;

export async function startBrowser() {
  const asRoot = process.getuid && process.getuid() === 0;
  browser = await chromium.launch({
    executablePath: chromiumPath, headless: true, args: asRoot ? ["--no-sandbox"] : [],
  });
}

export const stopBrowser = () => browser?.close();

/**
 * Opens a page file and hands it to `look(page)` once it has checked itself. Options are those of a
 * browser context, and `before` is a script that runs first. A request that is not to the disk, an
 * error on the console or a dialog fails; what the page's own policy refused does not where it is
 * `refusing`. A page that is not `checking` has no check of its own.
 */
export async function withPage(file, look, { before, refusing = false, checking = true, ...options } = {}) {
  const context = await browser.newContext({ offline: true, viewport: { width: 1000, height: 900 }, ...options });
  const trouble = [];
  try {
    const page = await context.newPage();
    page.on("request", (request) => {
      if (!/^(file|data):/.test(request.url())) trouble.push(`asked for ${request.url()}`);
    });
    page.on("console", (message) => {
      const refused = refusing && message.text().includes("Content Security Policy");
      if (message.type() === "error" && !refused) trouble.push(`console: ${message.text()}`);
    });
    page.on("pageerror", (error) => trouble.push(`error: ${error.message}`));
    page.on("dialog", (dialog) => {
      trouble.push(`dialog: ${dialog.message()}`);
      dialog.dismiss();
    });
    if (before) await page.addInitScript(before);
    await page.goto(pathToFileURL(file).href);
    if (checking && options.javaScriptEnabled !== false) {
      await page.waitForSelector(refusing ? "#self-check *" : "html[data-check]", { timeout: 20000 });
      // One turn more: charts are laid out after the check.
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50))));
    }
    const result = await look(page);
    assert.deepEqual(trouble, []);
    return result;
  } finally {
    await context.close();
  }
}

/** The outcome of the page's own check: {state, words}. */
export const outcomeOf = (page) => page.evaluate(() => {
  const check = document.getElementById("self-check");
  for (const folded of check.querySelectorAll("details")) folded.open = true;
  return { state: document.documentElement.dataset.check, words: check.innerText };
});

/** The outcome of a page file. */
export const checkPage = (file, options) => withPage(file, outcomeOf, options);

/** axe-core's violations, in words. Rules of every kind that axe has switched on. */
export async function violationsOf(page) {
  await page.evaluate(axeSource);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return violations.map(({ id, help, nodes }) =>
    `${id}: ${help}: ${nodes.slice(0, 3).map(({ html }) => html.slice(0, 150)).join(" | ")}`);
}
