// The pages that the tests open: made by the program from the examples, then changed where a test says so.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { run, runcert, sources, workFolder } from "./programs.mjs";

const inWork = (...parts) => path.join(workFolder, ...parts);
const example = (name) => path.join(sources, "examples", name, "attempt.yaml");
const made = new Map();

/** What `make` returns, made at the first call. */
function once(name, make) {
  if (!made.has(name)) made.set(name, make());
  return made.get(name);
}

export function startWork() {
  fs.rmSync(workFolder, { recursive: true, force: true });
  fs.mkdirSync(inWork("edited"), { recursive: true });
}

/** A new key pair without passphrase: {secret, public, line} (line: the key in base64). */
export const key = (name) => once(`key ${name}`, () => {
  runcert(["runcert", "keygen", "--no-password", "--out", inWork(name)]);
  const line = fs.readFileSync(inWork(`${name}.pub`), "utf8").split("\n")[1];
  return { secret: inWork(`${name}.key`), public: inWork(`${name}.pub`), line };
});

/** The run folder of an attempt; whether its record is beaten does not matter here. */
const certify = (name, attempt, args) => once(name, () => {
  runcert(["runcert", "certify", attempt, "--no-pdf", "--out", inWork(name), ...args], [0, 1]);
  return inWork(name);
});

export const signedRun = () => certify("signed", example("salt_lake"), ["--key", key("measurer").secret]);
export const unsignedRun = () => certify("unsigned", example("salt_lake"), []);
/** By one rule, which is beaten: its speed stands in large letters. */
export const beatenRun = () => certify("beaten", example("land_yacht"), ["--key", key("measurer").secret]);
export const rejectedRun = () => certify("rejected", example("rejected"), ["--key", key("measurer").secret]);

/** A text in YAML's double quotes, everything beyond ASCII as an escape. */
const inYaml = (text) => JSON.stringify(text).replace(/[^ -~]/g, (letter) =>
  "\\u" + letter.charCodeAt(0).toString(16).padStart(4, "0"));

/** A signed run of an attempt whose free fields hold what a page could take for its own. */
export const hostileRun = () => {
  const folder = inWork("hostile-attempt");
  fs.cpSync(path.dirname(example("salt_lake")), folder, { recursive: true });
  const attempt = fs.readFileSync(path.join(folder, "attempt.yaml"), "utf8")
    .replace(/name: [^,}\n]+/, () => `name: ${inYaml(hostileText)}`)
    .replace(/^place: .*$/m, `place: ${"W".repeat(10000)}`)
    .replace(/^ {2}source: .*$/m, `  source: ${inYaml(steering + hostileText)}`)
    .replace(/^profiles:/m, () => `signatures: [{role: judge, count: 2}]\nprofiles:`);
  fs.writeFileSync(path.join(folder, "attempt.yaml"), attempt);
  return certify("hostile", path.join(folder, "attempt.yaml"), ["--key", key("measurer").secret]);
};
export const hostileText = "</script><script>document.title='taken'</script><!-- {{report_id}} &amp; & \"'<b>⛵\\u003c";
/** As a page shows it: what is claimed stands in quotation marks that it cannot close. */
export const hostileClaimed = `“${hostileText.replaceAll('"', "'")}”`;
/** What an attempt may hold of what is no letter: marks that turn the direction, control characters and no characters are refused when it is read. */
const steering = "\n\t";
/** As the page shows them. */
export const steeringShown = "  ";

/** The page of a day: two runs, many that failed, and names that a page could take for its own. */
export const dayPage = () => once("day", () => {
  const folder = inWork("day");
  const runs = { refused: rejectedRun(), lake: unsignedRun() };
  const attempts = Object.entries(runs).map(([name, run]) => {
    const { id } = reportOf(run).predicate.attempt;
    fs.cpSync(run, path.join(folder, id), { recursive: true });
    return { id, source: `day.yaml:${name}`, state: "done", notes: [hostileText] };
  });
  for (const text of [hostileText, "W".repeat(200), "\u202egnp.exe\u0007", ...Array(12).fill("cut off")])
    attempts.push({ id: text, source: text, state: "failed", step: "import", problem: text, where: text, remedy: text, notes: [text] });
  attempts.push({ id: "W".repeat(200), source: hostileText, state: "not_processed", reason: hostileText, notes: [] });
  fs.writeFileSync(path.join(folder, "list.json"), JSON.stringify({ day: hostileText, attempts, notes: ["W".repeat(10000)] }));
  runcert(["../tests/runcert-day-page", folder, path.join(folder, "list.json")]);
  return path.join(folder, "day.html");
});

/** A copy of a run folder, to be signed again. */
function copyOf(run_folder, name) {
  fs.cpSync(run_folder, inWork(name), { recursive: true });
  return inWork(name);
}

function render(folder) {
  runcert(["runcert-report", "--render-only", "--page", "report.html", "--run-dir", folder, "--attempt", path.join(folder, "attempt.yaml")]);
}

/** A run signed by a measurer (minisign and ssh) and by a judge. */
export const manySignersRun = () => once("many", () => {
  const folder = copyOf(signedRun(), "many");
  fs.rmSync(inWork("ssh-key"), { force: true });
  run("ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "", "-f", inWork("ssh-key"));
  run("ssh-keygen", "-q", "-Y", "sign", "-f", inWork("ssh-key"), "-n", "observer@runcert", path.join(folder, "report.json"));
  runcert(["runcert", "sign", folder, "--key", key("judge").secret, "--role", "judge"]);
  return folder;
});
export const sshPublicKey = () => inWork("ssh-key.pub");

/** A run signed by the program minisign, whose comment names no key. */
export const foreignSignatureRun = () => once("foreign", () => {
  const folder = copyOf(unsignedRun(), "foreign");
  run("minisign", "-S", "-s", key("measurer").secret, "-m", path.join(folder, "report.json"));
  render(folder);
  return folder;
});

/** A run signed over ssh by a key that is not Ed25519. */
export const ecdsaRun = () => once("ecdsa", () => {
  const folder = copyOf(unsignedRun(), "ecdsa");
  run("ssh-keygen", "-q", "-t", "ecdsa", "-N", "", "-f", inWork("ecdsa-key"));
  run("ssh-keygen", "-q", "-Y", "sign", "-f", inWork("ecdsa-key"), "-n", "measurer@runcert", path.join(folder, "report.json"));
  render(folder);
  return folder;
});

export const pageOf = (folder) => path.join(folder, "report.html");
export const reportOf = (folder) => JSON.parse(fs.readFileSync(path.join(folder, "report.json"), "utf8"));

/** The block that stands in large letters in a report. */
export const headlineOf = (folder) => reportOf(folder).predicate.document.sections
  .flatMap(({ blocks }) => blocks).find(({ kind }) => kind === "headline");

/** The page of a run, changed by `change(text)`, as a file of its own. It must have changed. */
export function editedPage(folder, name, change) {
  const text = fs.readFileSync(pageOf(folder), "utf8");
  const changed = change(text);
  assert.notEqual(changed, text, `the edit “${name}” changes the page`);
  fs.writeFileSync(inWork("edited", `${name}.html`), changed);
  return inWork("edited", `${name}.html`);
}

/** Replaces the inside of the one script element with an id by `change(inside)`. */
export function changePart(text, id, change) {
  const element = new RegExp(`(<script[^>]* id="${id}"[^>]*>)([^]*?)(</script>)`, "g");
  assert.equal([...text.matchAll(element)].length, 1, `one part ${id}`);
  return text.replace(element, (all, begin, inside, end) => begin + change(inside) + end);
}

/** The inside of a script element with an id. */
export function partOf(text, id) {
  let part = null;
  changePart(text, id, (inside) => (part = inside));
  return part;
}

/** Replaces the inside of <main> by `change(inside)`. */
export function changeMain(text, change) {
  const [begin, end] = [text.indexOf("<main"), text.indexOf("</main>")];
  assert.ok(begin >= 0 && end > begin, "the page has a <main>");
  return text.slice(0, begin) + change(text.slice(begin, end)) + text.slice(end);
}

/** Another letter or digit than the one given. */
export function anotherLetter(letter) {
  if (/\d/.test(letter)) return String((Number(letter) + 1) % 10);
  return letter === "x" ? "y" : "x";
}

/** What `verify` says of a run folder that has this page. */
export function verifyWithPage(folder, page, status = 1) {
  const copy = copyOf(folder, "verified");
  fs.rmSync(path.join(copy, "report.pdf"), { force: true });  // which takes longest to render
  fs.copyFileSync(page, pageOf(copy));
  return runcert(["runcert", "verify", copy, "--pubkey", key("measurer").public], [status]);
}

/** Replaces the page's script by `change(script)`, and the hash that its policy names with it. */
export function changeScript(text, change) {
  const changed = changePart(text, "page-script", change);
  const hash = createHash("sha256").update(partOf(changed, "page-script")).digest("base64");
  return changed.replace(/sha256-[^']*/, `sha256-${hash}`);
}
