"use strict";
// The page checks itself: signatures, shown text and drawings, and says at the top what came out.

const checkStates = {
  valid: { mark: "✓", title: "This page shows what was signed." },
  tampered: { mark: "✗", title: "DO NOT TRUST THIS PAGE." },
  unsigned: { mark: "!", title: "UNSIGNED: nobody answers for this report." },
  unchecked: { mark: "?", title: "UNCHECKED: this page could not check who signed." },
};

const whoseKey = "Only you can know whose key this is: compare it with the key that the signer gave " +
  "you. A page cannot vouch for itself: whoever can change it can change this check; runcert verify " +
  "decides.";

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

function embeddedList(id) {
  try {
    return JSON.parse(embeddedText(id));
  } catch (error) {
    throw error instanceof PageFault ? error : new PageFault(`the part “${id}” of this page was changed`);
  }
}

/** Everything that the page shows and that was not signed, in words. Leaves the page as it is. */
function faultsOfPage(predicate, signatureFiles) {
  const main = document.querySelector("main#report");
  if (!main) throw new PageFault("the page has no report");
  const signed = renderSigned(embeddedText("page-template"), predicate, signersOf(signatureFiles));
  return [firstDifference(main, signed), besideReport(document.body)]
    .filter((fault) => fault !== null)
    .concat(changedDrawings(main, embeddedList("drawing-hashes")));
}

/** The state of the page with its faults and what is known of each signature. */
async function findingsOfPage() {
  const { json, predicate } = embeddedReport();
  const signatureFiles = embeddedList("signature-files");
  const faults = faultsOfPage(predicate, signatureFiles);
  const canVerify = await browserKnowsEd25519();
  const identity = { report: predicate.report_id, attempt: predicate.attempt.id };
  const signatures = canVerify
    ? await Promise.all(signatureFiles.map((file) => checkSignature(file, utf8Bytes(json), identity)))
    : [];
  for (const { file, state, words } of signatures)
    if (state === "invalid") faults.push(`${file}: ${words}`);
  const notes = signatures.filter(({ state }) => state === "unchecked")
    .map(({ file, words }) => `${file}: ${words}`);
  if (!canVerify && signatureFiles.length > 0)
    notes.push("This browser cannot verify Ed25519 signatures (WebCrypto). Open the page in a newer " +
      "one, or use runcert verify.");
  const valid = signatures.filter(({ state }) => state === "valid");
  const state = faults.length > 0 ? "tampered" : signatureFiles.length === 0 ? "unsigned"
    : valid.length > 0 ? "valid" : "unchecked";
  return { state, faults, notes, valid };
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

function showFindings({ state, faults, notes, valid }) {
  const { mark, title } = checkStates[state];
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
