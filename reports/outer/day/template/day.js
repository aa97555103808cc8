"use strict";
// The page of a day's results does nothing by itself but let its tables be sorted. In a table of one
// row nothing sorts: what stands beneath the row would.

for (const table of document.querySelectorAll("table.sortable"))
    if (table.tBodies.length < 2) table.classList.remove("sortable");
makeTablesSortable();
