"use strict";
// The page checks the report that it carries: its signatures, and the hashes of script and style
// sheet that it names. At the top it says what came out, and what was not compared.

const checkStates = {
  valid: { mark: "✓", title: "The report inside this page is signed." },
  tampered: { mark: "✗", title: "DO NOT TRUST THIS PAGE." },
  unsigned: { mark: "!", title: "UNSIGNED: nobody answers for this report." },
  unchecked: { mark: "?", title: "UNCHECKED: this page could not check who signed." },
};

const notCompared = "What you read here was not compared with the report inside this page: runcert verify does that.";

const whoseKey = "Only you can know whose key this is: compare it with the key that the signer gave " +
  "you. A page cannot vouch for itself: whoever can change it can change this check; runcert verify " +
  "decides.";

/** What the page shows of answers is of its maker, who may be anybody. */
const standingNote = ({ roster_sha256: roster }) => "Its standing, and who answered what, are not signed: they were " +
  "computed when the page was made, " + (roster ? `with the roster of keys whose SHA-256 is ${roster}` : "without a roster of keys") +
  ". Only runcert verify with a roster of your own says whether they hold.";

/**
 * A text without what has no place in a page: control characters, what is not seen or turns the
 * direction of writing, and what is no character. As plain_text of the program, whose Unicode is 15.1.
 */
const withoutControls = (text) => text.replace(/[\r\n\t]/g, " ")
  .replace(/[\u0000-\u001f\u007f-\u009f\u2028\u2029]/g, "\ufffd")
  .replace(/[\p{Default_Ignorable_Code_Point}\p{Noncharacter_Code_Point}]/gu, "\ufffd");

/** The text of the one element with an id. PageFault where there is none, or more than one. */
function embeddedText(id) {
  const found = document.querySelectorAll(`#${id}`);
  if (found.length !== 1) throw new PageFault(`the page has ${found.length} parts “${id}” instead of one`);
  return found[0].textContent;
}

/** What stands in a part of the page, read as JSON; numbers as the text that they were written as: "1.0". */
function embeddedPart(id) {
  const stringOrNumber = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g;
  const quoted = (token) => token.startsWith("\"") ? token : `"${token}"`;
  const text = embeddedText(id);
  try {
    return JSON.parse(text.replace(stringOrNumber, quoted));
  } catch (error) {
    throw new PageFault(`the part “${id}” of this page is not JSON: it was changed`);
  }
}

/** The embedded report: its text as signed, and its predicate with numbers as written. */
const embeddedReport = () =>
  ({ json: embeddedText("report-json"), predicate: embeddedPart("report-json").predicate });

const sha256Of = (text) => hexOf(nobleHashes.sha256(utf8Bytes(text)));

/** What of the page is not what the report names by its hash, in words. */
function otherParts({ page }) {
  const faults = [];
  if (sha256Of(embeddedText("page-script")) !== page.script_sha256)
    faults.push("the script of this page is not the one that the report names");
  if (sha256Of(document.querySelector("style")?.textContent ?? "") !== page.style_sha256)
    faults.push("the style sheet of this page is not the one that the report names");
  return faults;
}

/** The state of the page with its faults and what is known of each signature. */
async function findingsOfPage() {
  const { json, predicate } = embeddedReport();
  const signatureFiles = embeddedPart("signature-files");
  const standing = embeddedPart("standing");
  const answered = standing.slots !== undefined;
  const canVerify = await browserKnowsEd25519();
  const identity = { report: predicate.report_id, attempt: predicate.attempt.id };
  const signatures = canVerify
    ? await Promise.all(signatureFiles.map((file) => checkSignature(file, utf8Bytes(json), identity)))
    : [];
  const all = (wanted) => signatures.filter(({ state }) => state === wanted);
  const words = (wanted) => all(wanted).map((one) => `${one.file}: ${one.words}`);
  const faults = [...otherParts(predicate), ...words("invalid")];
  const notes = words("unchecked");
  if (answered) notes.push(standingNote(standing));
  if (!canVerify && signatureFiles.length > 0)
    notes.push("This browser cannot verify Ed25519 signatures (WebCrypto). Open the page in a newer " +
      "one, or use runcert verify.");
  const valid = all("valid");
  const state = faults.length > 0 ? "tampered" : signatureFiles.length === 0 ? "unsigned"
    : valid.length > 0 ? "valid" : "unchecked";
  return { state, faults, notes, valid, answered };
}

/** Names and what they are, those left out that are nothing. */
const listFacts = (facts) => makeElement("dl", "", ...facts.filter(([, value]) => value).map(([name, value]) =>
  makeElement("div", "", makeElement("dt", "", name),
    makeElement("dd", "", makeElement("bdi", "", withoutControls(value))))));

const describeSigner = ({ role, time, keyId, fingerprint, publicKey, file }) => makeElement("div", "check-signer",
  listFacts([["Role", role || "not stated"], ["Time, as the signer states it", time || "not stated"],
    ["Fingerprint of the key", fingerprint]]),
  makeElement("details", "", makeElement("summary", "", "The key, to compare it"),
    listFacts([["Key id", keyId], ["Public key", publicKey], ["Signature file", file]])));

function showFindings({ state, faults, notes, valid, answered }) {
  const { mark, title: plain } = checkStates[state];
  const title = state === "valid" && answered ? "The report inside this page is signed; the standing shown is not." : plain;
  const sign = makeElement("span", "check-mark", mark);
  sign.setAttribute("aria-hidden", "true");
  const parts = [makeElement("p", "check-title", sign, " ", makeElement("strong", "", title))];
  const list = (items, className) => makeElement("ul", className,
    ...items.map((item) => makeElement("li", "", withoutControls(item))));
  if (faults.length > 0)
    parts.push(makeElement("p", "", "What is wrong:"), list(faults, "check-faults"));
  if (notes.length > 0) parts.push(list(notes, "check-notes"));
  if (state !== "tampered") parts.push(makeElement("p", "", notCompared));
  if (state === "valid") parts.push(...valid.map(describeSigner));
  parts.push(makeElement("p", "check-whose", state === "valid" ? whoseKey
    : "A page cannot vouch for itself: runcert verify decides."));
  const box = document.getElementById("self-check") || document.body.insertBefore(
    makeElement("div", ""), document.body.firstChild);
  box.replaceChildren(...parts);
  box.classList.add("check", `check-${state}`);
}

/**
 * Checks the page and says what came out, in #self-check and as
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
