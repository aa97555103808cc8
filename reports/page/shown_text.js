"use strict";
// What the page shows against what was signed: the template is rendered again from the signed JSON.

/** JSON in which every number stays the text that it was written as: "1.0" is shown as 1.0. */
function parseWithNumbersAsWritten(json) {
  const stringOrNumber = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g;
  return JSON.parse(json.replace(stringOrNumber,
    (token) => token.startsWith("\"") ? token : `"${token}"`));
}

/**
 * A text without what has no place in a page: control characters, what is not seen or turns the
 * direction of writing, and what is no character. As plain_text of the program, whose Unicode is 15.1.
 */
const withoutControls = (text) => text.replace(/[\r\n\t]/g, " ")
  .replace(/[\u0000-\u001f\u007f-\u009f\u2028\u2029]/g, "\ufffd")
  .replace(/[\p{Default_Ignorable_Code_Point}\p{Noncharacter_Code_Point}]/gu, "\ufffd");

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

/** A block as the template gets it: with is_KIND, and cells that know the heads of their columns. */
function shownBlock({ kind, look, slot, text, sign, beside, items, facts, columns, rows, plots }) {
  // Nothing else of a block reaches the template, whatever the JSON has.
  const given = { kind, look, slot, text, sign, beside, items, columns, plots,
    facts: facts?.map(({ name, value, mark }) => ({ name, value, ...(mark === undefined ? {} : { mark }) })) };
  const shown = Object.fromEntries(Object.entries(given).filter(([, value]) => value !== undefined));
  shown["is_" + kind] = true;
  if (rows === undefined) return shown;
  const cellsOf = ({ cells, share }) => cells.slice(0, columns.length).map((cell, index) => ({
    cell, first: index === 0, number: columns[index].numbers, head: columns[index].head ?? "",
    share: index + 1 === cells.length && share !== undefined ? share : "",
  }));
  return {
    ...shown, has_heads: columns.some(({ head }) => head !== undefined),
    rows: rows.map(({ cells, share, mark, further }) => ({
      cells: cellsOf({ cells, share }), span: String(columns.length),
      ...(mark === undefined ? {} : { mark }), ...(further === undefined ? {} : { further }),
    })),
  };
}

/** Sections of a document as the template gets them; a first page has the contents of the others. */
function shownSections({ sections }) {
  const shown = sections.map(({ anchor, title, layout, blocks }) => ({
    anchor, ...(layout === undefined ? {} : { layout }), ...(title === undefined ? {} : { section_title: title }),
    blocks: blocks.map(shownBlock),
  }));
  if (shown.length > 0 && shown[0].layout === "first_page")
    shown[0].contents = sections.filter(({ title }) => title !== undefined)
      .map(({ anchor, title }) => ({ entry: anchor, entry_title: title }));
  return shown;
}

/** The document with a picture for each plot, and with the blocks of the standing in their places, and in no others. */
function withPictures({ sections }, pictures, slots) {
  const pictured = ({ plot, plot_title: title, caption }) => ({ plot, plot_title: title, caption,
    image: `<img src="${pictures[plot]}" alt="${escapeHtml(title)}">` });
  // Answers are of the same kind as what they replace: no outcome becomes a figure in large letters.
  const isAnswered = ({ slot, kind }) => slot !== undefined && Object.hasOwn(slots, slot) && slots[slot].kind === kind;
  const placed = (signed) => {
    const block = isAnswered(signed) ? slots[signed.slot] : signed;
    return block.plots === undefined ? block : { ...block, plots: block.plots.map(pictured) };
  };
  return { sections: sections.map((section) => ({ ...section, blocks: section.blocks.map(placed) })) };
}

/** The code that leads from paper to report.json: its id and SHA-256, as squares of one path. */
function codeImage(reportId, sha256) {
  const code = qrCodes.QrCode.encodeText(`RUNCERT ${reportId} ${sha256}`.toUpperCase(), qrCodes.QrCode.Ecc.MEDIUM);
  const border = 4; // light modules around it (ISO/IEC 18004)
  let path = "";
  for (let y = 0; y < code.size; ++y)
    for (let x = 0; x < code.size; ++x)
      if (code.getModule(x, y)) path += `M${x + border},${y + border}h1v1h-1z`;
  const side = code.size + 2 * border;
  return `<svg width="${side}" height="${side}" viewBox="0 0 ${side} ${side}" role="img" aria-label="Code of the report's id and hash">` +
    `<path d="${path}" fill="#000000"></path></svg>`;
}

/** The data of the sections' template: the report's document, who signed, and the picture of each figure. */
function contentData(predicate, signers, pictures, { report_json: json, slots }) {
  const sha256 = hexOf(nobleHashes.sha256(utf8Bytes(json)));
  const data = templateData({
    sections: shownSections(withPictures(predicate.document, pictures, slots)),
    signed: signers.length > 0, signers,
    missing_signatures: missingSignatures(predicate.signatures_required || [], signers),
    report_sha256: sha256,
  });
  data.code_image = codeImage(predicate.report_id, sha256);
  return data;
}

/**
 * The whole page as it was made, in a document of its own in which nothing runs: rendered from the
 * signed JSON with the templates and the style of this script. `carried` are the texts that it
 * carries: report_json, signature_files, standing and script; `slots` the blocks of the standing.
 */
function renderPage(predicate, signers, pictures, carried, slots) {
  const escape = { escape: escapeHtml };
  const content = Mustache.render(pageParts.content,
    contentData(predicate, signers, pictures, { ...carried, slots }), undefined, escape);
  const { report_id, program, attempt, page } = predicate;
  const html = Mustache.render(pageParts.page, {
    ...carried, content, style: pageParts.style, signed: signers.length > 0,
    issued: withoutControls(signers.map(({ signed_at: time }) => time).filter((time) => time !== "").sort()[0] ?? ""),
    report_id: withoutControls(report_id), version: withoutControls(program.version),
    subtitle: withoutControls(predicate.document.subtitle ?? ""),
    title: withoutControls(`Measurement report ${report_id}: ${attempt.id}`),
    script_hash: base64Of(bytesOfHex(page.script_sha256)),
  }, undefined, escape);
  return new DOMParser().parseFromString(html, "text/html");
}

/**
 * All of a tree, as a list of {text} and {element}: without <wbr> and white space that is not seen.
 */
function partsOf(root) {
  const parts = [];
  const addText = (text) => {
    const last = parts[parts.length - 1];
    if (last && last.text !== undefined) last.text += text;
    else parts.push({ text });
  };
  const walk = (node) => {
    if (node.nodeType === Node.TEXT_NODE) return addText(node.data);
    if (node.nodeType !== Node.ELEMENT_NODE) return parts.push({ element: `<!--${node.data ?? node.nodeName}-->` });
    if (node.localName === "wbr" && node.attributes.length === 0) return;
    const attributes = Array.from(node.attributes,
      (attribute) => `${attribute.name}="${attribute.value.replaceAll("<wbr>", "")}"`).sort();
    parts.push({ element: `<${[node.localName, ...attributes].join(" ")}>` });
    node.childNodes.forEach(walk);
    parts.push({ element: `</${node.localName}>` });
  };
  walk(root);
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

/** Where a page first differs from the one that was made, in words; null where it does not. */
function firstDifference(shownPage, madePage) {
  const shown = partsOf(shownPage);
  const made = partsOf(madePage);
  const same = (a, b) => a && b && a.text === b.text && a.element === b.element;
  let at = 0;
  while (at < shown.length && same(shown[at], made[at])) ++at;
  if (at === shown.length && at === made.length) return null;
  const wordsAt = (parts) => parts.slice(at, at + 2).map(({ text, element }) => text ?? element).join(" ");
  const quoted = (parts, others) => at === parts.length ? "nothing"
    : `“${aroundDifference(wordsAt(parts), wordsAt(others))}”`;
  return `the page is other than it was made: ${quoted(shown, made)}, where ${quoted(made, shown)} was signed`;
}

/**
 * The pictures of the page, {sources, faults}: a source for each figure of the report, empty where
 * the page has not just the drawing whose hash the report names.
 */
function signedPictures(page, figures) {
  const shown = figures.map((figure, index) => page.querySelector(`#figure-${index} > .drawing > img`));
  const begin = "data:image/svg+xml;base64,";
  const sources = figures.map(({ drawing_sha256: hash }, index) => {
    const source = shown[index]?.getAttribute("src") ?? "";
    if (!source.startsWith(begin)) return "";
    const bytes = bytesOfBase64(source.slice(begin.length), "drawing");
    return hexOf(nobleHashes.sha256(bytes)) === hash ? source : "";
  });
  return { sources, faults: sources.flatMap((source, index) => source === "" ? [`drawing ${index + 1} was changed`] : []) };
}

/** Trees that are shown in place of an element's own children (declarative shadow roots), in words. Spoils the page. */
function hiddenTrees(page) {
  const hosts = Array.from(page.querySelectorAll("*")).filter((element) => {
    if (element.shadowRoot) return true;
    try {
      element.attachShadow({ mode: "open" });
      return false;
    } catch (error) {
      return hostNames.has(element.localName);  // others can have none
    }
  });
  return hosts.slice(0, 1).map((host) => `<${host.localName}> showed something else than what stands in it`);
}
const hostNames = new Set(["article", "aside", "blockquote", "body", "div", "footer", "h1", "h2", "h3", "h4", "h5",
  "h6", "header", "main", "nav", "p", "section", "span"]);
