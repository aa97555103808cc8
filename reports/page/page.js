"use strict";
// Begins what the page does by itself, once every script of the page has been read.

/** Checks the page, and only then touches it: tables first, charts after. */
async function startPage() {
  await selfCheck();
  makeTablesSortable();
  makeCharts();
}

document.addEventListener("DOMContentLoaded", startPage);
