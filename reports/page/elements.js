"use strict";
// What every other script makes elements with.

/** An element with a class, and text or elements inside. */
function makeElement(name, className, ...inside) {
  const element = document.createElement(name);
  if (className) element.className = className;
  element.append(...inside);
  return element;
}
