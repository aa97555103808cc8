"use strict";
// The page of a day's results does nothing by itself but let its tables be sorted.

document.addEventListener("DOMContentLoaded", makeTablesSortable);
