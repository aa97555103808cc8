// The report's page and that of a day in Chromium. One process for all: the pages are made once.
import { after, before } from "node:test";
import { startBrowser, stopBrowser } from "./browser.mjs";
import { startWork } from "./pages.mjs";

before(async () => {
  startWork();
  await startBrowser();
});
after(stopBrowser);

await import("./self_check.mjs");
await import("./charts.mjs");
await import("./tables.mjs");
await import("./accessibility.mjs");
await import("./day.mjs");
