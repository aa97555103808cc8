"use strict";
// What the page shows against what was signed: the template is rendered again from the signed JSON.

/** JSON in which every number stays the text that it was written as: "1.0" is shown as 1.0. */
function parseWithNumbersAsWritten(json) {
  const stringOrNumber = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g;
  return JSON.parse(json.replace(stringOrNumber,
    (token) => token.startsWith("\"") ? token : `"${token}"`));
}

/**
 * A text without what has no place in a page: control characters, what turns the direction of writing
 * and could do so beyond its own end, and what is no character. As plain_text of the program.
 */
const withoutControls = (text) => text.replace(/[\r\n\t]/g, " ")
  .replace(/[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g, "\ufffd")
  .replace(/\p{Noncharacter_Code_Point}/gu, "\ufffd");

/** What the template gets for a value of the JSON; objects have has_NAME beside each list. */
function templateData(value) {
  if (Array.isArray(value)) return value.map(templateData);
  if (value === null) return "null";
  if (typeof value === "object") {
    const data = Object.create(null);
    for (const [name, member] of Object.entries(value)) {
      data[name] = templateData(member);
      if (Array.isArray(member)) data["has_" + name] = member.length > 0;
    }
    return data;
  }
  return typeof value === "string" ? withoutControls(value) : value;
}

const htmlEscapes = { "&": "&amp;", "<": "&lt;", ">": "&gt;", "\"": "&quot;", "'": "&#39;" };

/** Text for HTML; as in the program's own renderer, nothing that is not a text is shown. */
const escapeHtml = (value) => typeof value === "string"
  ? value.replace(/[&<>"']/g, (letter) => htmlEscapes[letter]) : "";

/** For each role that the report needs, how many keys more must sign in it. */
function missingSignatures(required, signers) {
  const missing = [];
  for (const { role, count } of required) {
    const keys = new Set(signers.filter((signer) => signer.role === role).map(({ key_id }) => key_id));
    if (keys.size < count) missing.push({ missing_role: role, missing_count: String(count - keys.size) });
  }
  return missing;
}

/** The data of the whole template: the report's predicate, who signed, and a picture in each figure. */
function pageData(predicate, signers) {
  const data = templateData({ ...predicate, signed: signers.length > 0, signers,
    missing_signatures: missingSignatures(predicate.signatures_required || [], signers) });
  data.two_receivers = (data.receivers || []).length > 1;
  for (const figure of data.figures || [])
    if (figure.curves) figure.image = `<img alt="${escapeHtml(figure.figure_title)}">`;  // its source is checked by its hash
  return data;
}

/** The inside of <main> as it was signed, in a document of its own in which nothing runs. */
function renderSigned(template, predicate, signers) {
  const inside = Mustache.render(template, pageData(predicate, signers), undefined, { escape: escapeHtml });
  const parsed = new DOMParser().parseFromString(`<!DOCTYPE html><main>${inside}</main>`, "text/html");
  return parsed.querySelector("main");
}

/**
 * What of a tree can be read, as a list of {text} and {element}: of a drawing only the words
 * for it (its hash is checked apart), without <wbr> and without white space that is not seen.
 */
function readableParts(root) {
  const parts = [];
  const addText = (text) => {
    const last = parts[parts.length - 1];
    if (last && last.text !== undefined) last.text += text;
    else parts.push({ text });
  };
  const walk = (node) => {
    if (node.nodeType === Node.TEXT_NODE) return addText(node.data);
    if (node.nodeType !== Node.ELEMENT_NODE || node.localName === "wbr") return;
    const attributes = Array.from(node.attributes,
      (attribute) => `${attribute.name}="${attribute.value.replaceAll("<wbr>", "")}"`).sort();
    const alt = node.matches(".drawing") ? `: ${node.querySelector("img")?.alt}` : "";
    parts.push({ element: `<${[node.localName, ...attributes].join(" ")}>${alt}` });
    if (alt === "") node.childNodes.forEach(walk);
    parts.push({ element: `</${node.localName}>` });
  };
  root.childNodes.forEach(walk);
  for (const part of parts)
    if (part.text !== undefined) part.text = part.text.replace(/[ \t\n\f\r]+/g, " ").trim();
  return parts.filter((part) => part.text !== "");
}

/** About 60 characters of a text around the place where it begins to differ from another. */
function aroundDifference(text, other) {
  let at = 0;
  while (at < text.length && text[at] === other[at]) ++at;
  const begin = Math.max(0, at - 30);
  const end = Math.min(text.length, at + 30);
  return (begin > 0 ? "…" : "") + text.slice(begin, end) + (end < text.length ? "…" : "");
}

/** Where what is shown first differs from what was signed, in words; null where it does not. */
function firstDifference(shownRoot, signedRoot) {
  const shown = readableParts(shownRoot);
  const signed = readableParts(signedRoot);
  const same = (a, b) => a && b && a.text === b.text && a.element === b.element;
  let at = 0;
  while (at < shown.length && same(shown[at], signed[at])) ++at;
  if (at === shown.length && at === signed.length) return null;
  const words = (part, other) => part === undefined ? "nothing"
    : part.text !== undefined ? `“${aroundDifference(part.text, other?.text ?? "")}”`
    : part.element;
  return `the page shows other text than was signed: ${words(shown[at], signed[at])}, ` +
    `where ${words(signed[at], shown[at])} was signed`;
}

/** Whatever stands on the page beside the report and what checks it, in words; null where nothing. */
function besideReport(body) {
  const known = (node) => node.nodeType === Node.COMMENT_NODE ||
    (node.nodeType === Node.TEXT_NODE && node.data.trim() === "") ||
    (node.nodeType === Node.ELEMENT_NODE && (node.matches("script, noscript, main#report") ||
      (node.matches("div#self-check") && node.childNodes.length === 0)));
  const stranger = Array.from(body.childNodes).find((node) => !known(node));
  if (!stranger)
    return body.querySelector("main").attributes.length === 1 ? null
      : "the report as a whole is shown otherwise than it was made";
  const text = (stranger.textContent || "").trim() || `<${stranger.localName}>`;
  return `something stands beside the report that was not signed: “${text.slice(0, 60)}”`;
}

/** What is wrong with the drawings, in words: each must be the one picture with its hash. */
function changedDrawings(main, hashes) {
  const drawings = Array.from(main.querySelectorAll(".drawing"));
  if (drawings.length !== hashes.length)
    return [`the page has ${drawings.length} drawings, but ${hashes.length} were made`];
  const holds = (drawing, index) => {
    const [picture, ...others] = drawing.children;
    if (!picture || others.length > 0 || drawing.textContent.trim() !== "") return false;
    if (picture.localName !== "img" || picture.srcset !== "") return false;
    return hexOf(nobleHashes.sha256(utf8Bytes(picture.getAttribute("src") || ""))) === hashes[index];
  };
  return drawings.flatMap((drawing, index) => holds(drawing, index) ? []
    : [`drawing ${index + 1} was changed`]);
}
