"use strict";
// The page checks itself: it is made again from the signed JSON, compared with what was loaded, and
// shown in its place; at the top it says what came out, and what the signatures are.

const checkStates = {
  valid: { mark: "✓", title: "This page shows what was signed." },
  tampered: { mark: "✗", title: "DO NOT TRUST THIS PAGE." },
  unsigned: { mark: "!", title: "UNSIGNED: nobody answers for this report." },
  unchecked: { mark: "?", title: "UNCHECKED: this page could not check who signed." },
};

const whoseKey = "Only you can know whose key this is: compare it with the key that the signer gave " +
  "you. A page cannot vouch for itself: whoever can change it can change this check; runcert verify " +
  "decides.";

/** What the page shows of answers is of its maker, who may be anybody. */
const standingNote = ({ roster_sha256: roster }) => "Its standing, and who answered what, are not signed: they were " +
  "computed when the page was made, " + (roster ? `with the roster of keys whose SHA-256 is ${roster}` : "without a roster of keys") +
  ". Only runcert verify with a roster of your own says whether they hold.";

/** The text of the one element with an id. PageFault where there is none, or more than one. */
function embeddedText(id) {
  const found = document.querySelectorAll(`#${id}`);
  if (found.length !== 1) throw new PageFault(`the page has ${found.length} parts “${id}” instead of one`);
  return found[0].textContent;
}

/** The embedded report: its text as signed, and its predicate with numbers as written. */
function embeddedReport() {
  const json = embeddedText("report-json");
  try {
    return { json, predicate: parseWithNumbersAsWritten(json).predicate };
  } catch (error) {
    throw new PageFault("the report inside this page is not JSON: it was changed");
  }
}

/** What stands in a part of the page, read as JSON. */
function embeddedPart(id) {
  try {
    return parseWithNumbersAsWritten(embeddedText(id));
  } catch (error) {
    throw error instanceof PageFault ? error : new PageFault(`the part “${id}” of this page was changed`);
  }
}

/** The page as it was made, and all in which the loaded one differs from it, in words: {made, faults}. */
function comparePage(json, predicate, signatureFiles, standing) {
  const page = document.documentElement;
  const script = embeddedText("page-script");
  const { sources, faults } = signedPictures(page, predicate.figures);
  const shown = standing.with_files === true ? { ...predicate, document: predicate.with_files.document } : predicate;
  const made = renderPage(shown, signersOf(signatureFiles), sources,
    { report_json: json, signature_files: embeddedText("signature-files"), standing: embeddedText("standing"), script },
    standing.slots || {});
  if (hexOf(nobleHashes.sha256(utf8Bytes(script))) !== predicate.page.script_sha256)
    faults.unshift("the script of this page is not the one that the report names");
  const [first, ...beside] = document.childNodes;
  if (first?.nodeType !== Node.DOCUMENT_TYPE_NODE || document.compatMode !== "CSS1Compat" ||
      document.characterSet !== "UTF-8" || beside.length !== 1)
    faults.push("the file holds more than the page that was made, or begins otherwise");
  const difference = firstDifference(page, made.documentElement);
  return { made, faults: difference === null ? faults : [difference, ...faults] };
}

/** Shows the page as it was made in place of the loaded one. Returns what was hidden in that. */
function showAsMade(made) {
  const loaded = document.documentElement;
  document.replaceChild(document.adoptNode(made.documentElement), loaded);
  return hiddenTrees(loaded);
}

/** The state of the page with its faults and what is known of each signature. Shows it as it was made. */
async function findingsOfPage() {
  const { json, predicate } = embeddedReport();
  const signatureFiles = embeddedPart("signature-files");
  const standing = embeddedPart("standing");
  const { made, faults } = comparePage(json, predicate, signatureFiles, standing);
  const canVerify = await browserKnowsEd25519();
  const identity = { report: predicate.report_id, attempt: predicate.attempt.id };
  const signatures = canVerify
    ? await Promise.all(signatureFiles.map((file) => checkSignature(file, utf8Bytes(json), identity)))
    : [];
  for (const { file, state, words } of signatures)
    if (state === "invalid") faults.push(`${file}: ${words}`);
  const notes = signatures.filter(({ state }) => state === "unchecked")
    .map(({ file, words }) => `${file}: ${words}`);
  if (standing.slots !== undefined) notes.push(standingNote(standing));
  if (!canVerify && signatureFiles.length > 0)
    notes.push("This browser cannot verify Ed25519 signatures (WebCrypto). Open the page in a newer " +
      "one, or use runcert verify.");
  faults.push(...showAsMade(made));
  const valid = signatures.filter(({ state }) => state === "valid");
  const state = faults.length > 0 ? "tampered" : signatureFiles.length === 0 ? "unsigned"
    : valid.length > 0 ? "valid" : "unchecked";
  return { state, faults, notes, valid, answered: standing.slots !== undefined };
}

function listFacts(facts) {
  return makeElement("dl", "", ...facts.map(([name, value]) => makeElement("div", "",
    makeElement("dt", "", name), makeElement("dd", "", makeElement("bdi", "", withoutControls(value))))));
}

function describeSigner({ role, time, keyId, fingerprint, publicKey, file }) {
  const more = [["Public key", publicKey], ["Signature file", file]];
  if (keyId) more.unshift(["Key id", keyId]);
  return makeElement("div", "check-signer",
    listFacts([["Role", role || "not stated"], ["Time, as the signer states it", time || "not stated"],
      ["Fingerprint of the key", fingerprint]]),
    makeElement("details", "", makeElement("summary", "", "The key, to compare it"), listFacts(more)));
}

function showFindings({ state, faults, notes, valid, answered }) {
  const { mark, title: plain } = checkStates[state];
  const title = state === "valid" && answered ? "This page shows what was signed, and a standing that was not." : plain;
  const sign = makeElement("span", "check-mark", mark);
  sign.setAttribute("aria-hidden", "true");
  const parts = [makeElement("p", "check-title", sign, " ", makeElement("strong", "", title))];
  const list = (items, className) => makeElement("ul", className,
    ...items.map((item) => makeElement("li", "", withoutControls(item))));
  if (faults.length > 0)
    parts.push(makeElement("p", "", "What is wrong:"), list(faults, "check-faults"));
  if (notes.length > 0) parts.push(list(notes, "check-notes"));
  if (state !== "tampered" && state !== "valid")
    parts.push(makeElement("p", "", "The text and the drawings of this page are those of the report " +
      "inside it."));
  if (state === "valid") parts.push(...valid.map(describeSigner));
  parts.push(makeElement("p", "check-whose", state === "valid" ? whoseKey
    : "A page cannot vouch for itself: runcert verify decides."));
  const box = document.getElementById("self-check") || document.body.insertBefore(
    makeElement("div", ""), document.body.firstChild);
  box.replaceChildren(...parts);
  box.classList.add("check", `check-${state}`);
}

/**
 * Checks the page as it was loaded and says what came out, in #self-check and as
 * <html data-check="valid | tampered | unsigned | unchecked">. Returns that state. Trouble of any
 * kind is shown as trouble.
 */
async function selfCheck() {
  let findings = { state: "tampered", faults: [], notes: [], valid: [] };
  try {
    findings = await findingsOfPage();
  } catch (error) {
    findings.faults.push(error instanceof PageFault ? error.message
      : `the check could not be finished: ${error.message}`);
  }
  showFindings(findings);
  document.documentElement.dataset.check = findings.state;
  return findings.state;
}
