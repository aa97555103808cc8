// Pictures of reports, to look at: `node pictures.mjs OUT RUN_FOLDER...` writes every page of the PDF,
// and the page on a wide screen, on a telephone, in the dark and in shades of grey. It says what
// axe-core finds, and stops at no fault.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import path from "node:path";
import { outcomeOf, startBrowser, stopBrowser, violationsOf, withPage } from "./browser.mjs";

const views = {
  wide: { viewport: { width: 1100, height: 900 } },
  telephone: { viewport: { width: 360, height: 740 } },
  dark: { viewport: { width: 1100, height: 900 }, colorScheme: "dark" },
};

async function picturesOf(folder, out) {
  mkdirSync(out, { recursive: true });
  const pdf = path.join(folder, "report.pdf");
  if (existsSync(pdf)) {
    execFileSync("pdftoppm", ["-r", "90", "-png", pdf, path.join(out, "page")]);
    execFileSync("pdftoppm", ["-r", "90", "-gray", "-l", "1", pdf, path.join(out, "grey")]);
  }
  for (const [name, options] of Object.entries(views))
    await withPage(path.join(folder, "report.html"), async (page) => {
      await page.screenshot({ path: path.join(out, `${name}.png`), fullPage: true, timeout: 0 });
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      if (width > options.viewport.width) console.log(`${out}, ${name}: ${width} pixels wide, more than the screen`);
      for (const violation of await violationsOf(page)) console.log(`${out}, ${name}: ${violation}`);
      if (name === "wide") console.log(`${out}: ${JSON.stringify(await outcomeOf(page))}`);
    }, options);
}

const [out, ...folders] = process.argv.slice(2);
await startBrowser();
try {
  for (const folder of folders) await picturesOf(folder, path.join(out, path.basename(folder)));
} finally {
  await stopBrowser();
}
