// The page checks what it carries: what it says of whole, changed, unsigned and foreign pages.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { describe, test } from "node:test";
import { checkPage, outcomeOf, withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";
import { run, workFolder } from "./programs.mjs";

async function expectTampered(file, words, options) {
  const outcome = await checkPage(file, options);
  assert.equal(outcome.state, "tampered", outcome.words);
  assert.match(outcome.words, /DO NOT TRUST THIS PAGE/);
  assert.match(outcome.words, words);
  assert.doesNotMatch(outcome.words, /is signed/);
}

/** The line of an OpenSSH public key with the 32 bytes of a minisign key. */
function sshLineOf(minisignLine) {
  const string = (bytes) => Buffer.concat([Buffer.from([0, 0, 0, bytes.length]), bytes]);
  const bytes = Buffer.from(minisignLine, "base64").subarray(10);
  return `ssh-ed25519 ${Buffer.concat([string(Buffer.from("ssh-ed25519")), string(bytes)]).toString("base64")}\n`;
}

const fingerprintOf = (file) => run("ssh-keygen", "-l", "-f", file).split(" ")[1];

describe("a signed page", () => {
  test("says which key signed its report, what it did not compare, and who decides", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.signedRun()));
    assert.equal(state, "valid", words);
    const { line } = pages.key("measurer");
    const sshFile = path.join(workFolder, "measurer-as-ssh.pub");
    fs.writeFileSync(sshFile, sshLineOf(line));
    const comment = fs.readFileSync(pages.key("measurer").public, "utf8").split("\n")[0];
    assert.ok(words.includes(line), "the public key");
    assert.ok(words.includes(fingerprintOf(sshFile)), "the fingerprint that ssh-keygen gives");
    assert.ok(words.includes(/[0-9A-F]{16}/.exec(comment)[0]), "the key id");
    assert.match(words, /The report inside this page is signed/);
    assert.match(words, /was not compared with the report/);
    assert.match(words, /\bmeasurer\b/);
    assert.match(words, /Only you can know whose key this is/);
    assert.match(words, /runcert verify decides/);
  });

  test("with several signers, one of them over ssh, names each", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.manySignersRun()));
    assert.equal(state, "valid", words);
    for (const role of ["measurer", "judge", "observer"]) assert.match(words, new RegExp(`\\b${role}\\b`));
    assert.ok(words.includes(pages.key("judge").line));
    assert.ok(words.includes(fingerprintOf(pages.sshPublicKey())));
    assert.ok(words.includes(fs.readFileSync(pages.sshPublicKey(), "utf8").trim()));
  });

  test("of a rejected attempt is as valid as any other", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.rejectedRun()));
    assert.equal(state, "valid", words);
  });

  test("shows markup in free fields as text", async () => {
    await withPage(pages.pageOf(pages.hostileRun()), async (page) => {
      const { state, words } = await outcomeOf(page);
      assert.equal(state, "valid", words);
      assert.notEqual(await page.title(), "taken");
      const text = await page.evaluate(() => document.querySelector("main").textContent);
      assert.ok(text.includes(pages.hostileClaimed), "the name as it was written, in quotation marks");
      assert.ok(text.includes(`“${pages.steeringShown}${pages.hostileClaimed.slice(1)}`), "what steers is shown as such");
      assert.match(text, /2 in the role “judge”/);
      assert.equal(await page.locator("main script, main b, main style").count(), 0);
      assert.ok(text.includes("W".repeat(10000)), "a word of ten thousand letters");
    });
  });
});

describe("a changed page", () => {
  const edited = (name, change) => pages.editedPage(pages.signedRun(), name, change);

  test("one digit of the report inside it", async () => {
    await expectTampered(edited("json", (text) => pages.changePart(text, "report-json", (json) =>
      json.replace(/("speed_m_s": ?\d)(\d)/, (all, begin, digit) => begin + pages.anotherLetter(digit)))),
    /report\.json\.minisig: the signature of report\.json does not hold/);
  });

  test("white space in the report inside it, on the screen and in print", async () => {
    const file = edited("space", (text) => pages.changePart(text, "report-json", (json) => json + " "));
    await expectTampered(file, /the signature of report\.json does not hold/);
    await withPage(file, async (page) => {
      const frame = await page.evaluate(() => {
        const [frame, marks] = ["::after", "::before"].map((part) => getComputedStyle(document.documentElement, part));
        return { width: parseFloat(frame.borderTopWidth), position: frame.position, marks: marks.backgroundImage,
                 height: parseFloat(marks.height), whole: document.documentElement.scrollHeight };
      });
      assert.ok(frame.width > 5 && frame.position === "fixed", "a frame around whatever is seen");
      assert.match(frame.marks, /DO(%20| )NOT(%20| )TRUST/);
      assert.ok(frame.height >= frame.whole - 1, "words over the whole page");
      await page.emulateMedia({ media: "print" });
      assert.ok(await page.locator("#self-check").isVisible(), "printed, too, it says so");
    });
  });

  test("a report inside it that is none", async () => {
    await expectTampered(edited("no-json", (text) => pages.changePart(text, "report-json", (json) => json.slice(0, -9))),
      /is not JSON/);
    await expectTampered(edited("twice", (text) => text.replace("<main", "<script type=\"application/json\" id=\"report-json\">{}</script><main")),
      /2 parts “report-json”/);
  });

  test("a letter of the signature", async () => {
    const changeLine = (line, change) => (text) => pages.changePart(text, "signature-files", (json) => {
      const files = JSON.parse(json);
      const lines = files[0].text.split("\n");
      lines[line] = change(lines[line]);
      files[0].text = lines.join("\n");
      return JSON.stringify(files);
    });
    const at = (place) => (line) => line.slice(0, place) + pages.anotherLetter(line[place]) + line.slice(place + 1);
    await expectTampered(edited("signature", changeLine(1, at(50))), /signature of report\.json does not hold/);
    await expectTampered(edited("global", changeLine(3, at(50))), /trusted comment .*was changed/);
    await expectTampered(edited("comment", changeLine(2, (line) => line.replace(/role=\w+/, "role=director"))),
      /trusted comment .*was changed/);
    await expectTampered(edited("two-roles", changeLine(2, (line) => line + " role=director")),
      /states “role=” twice/);
    await expectTampered(edited("key", changeLine(2, (line) => line.replace(/(key=.{30})(.)/, (all, begin, letter) =>
      begin + pages.anotherLetter(letter)))), /does not hold/);
    await expectTampered(edited("cut", changeLine(1, (line) => line.slice(4))), /report\.json\.minisig/);
  });

  test("its script or style sheet", async () => {
    await expectTampered(edited("script", (text) => pages.changeScript(text, (script) => `${script}// more\n`)),
      /the script of this page is not the one/);
    await expectTampered(edited("style", (text) => text.replace("</style>", ".headline { visibility: hidden }</style>")),
      /the style sheet of this page is not the one/);
  });

  test("the signature of another attempt", async () => {
    const other = fs.readFileSync(pages.pageOf(pages.rejectedRun()), "utf8");
    await expectTampered(edited("replayed", (text) => pages.changePart(text, "signature-files", () =>
      pages.partOf(other, "signature-files"))), /a signature of another report/);
  });

  test("trouble in the check itself is not silent", async () => {
    await expectTampered(pages.pageOf(pages.signedRun()), /could not be finished: broken/,
      { before: "TextEncoder.prototype.encode = () => { throw new Error('broken'); };" });
  });
});

describe("a page that shows something else while it carries the signed report", () => {
  test("says that it did not compare, and is refused by verify", async () => {
    const speed = pages.headlineOf(pages.beatenRun()).text;
    const file = pages.editedPage(pages.beatenRun(), "speed", (text) => pages.changeMain(text, (main) =>
      main.replace(speed, pages.anotherLetter(speed[0]) + speed.slice(1))));
    assert.match((await checkPage(file)).words, /was not compared .* runcert verify does that/);
    assert.match(pages.verifyWithPage(pages.beatenRun(), file), /^NO +pages/m);
    assert.match(pages.verifyWithPage(pages.beatenRun(), pages.pageOf(pages.beatenRun()), 0), /^yes +pages/m);
  });

  test("one whose script the browser refuses says that it has not checked", async () => {
    const file = pages.editedPage(pages.signedRun(), "refused", (text) =>
      text.replace("charset=\"utf-8\"", "charset=\"windows-1252\""));
    const { state, words } = await checkPage(file, { refusing: true });
    assert.equal(state, undefined);
    assert.match(words, /has not checked its signatures/);
  });

  test("a standing that somebody put there is said to be nobody's", async () => {
    const file = pages.editedPage(pages.beatenRun(), "standing", (text) => pages.changePart(text, "standing", () =>
      `${JSON.stringify({ roster_sha256: "", slots: {} })}\n`));
    const { state, words } = await checkPage(file);
    assert.equal(state, "valid", words);
    assert.match(words, /is signed; the standing shown is not/);
    assert.match(words, /without a roster of keys/);
  });
});

describe("a page that nobody signed, or whose signature it cannot check", () => {
  test("unsigned", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.unsignedRun()));
    assert.equal(state, "unsigned", words);
    assert.match(words, /UNSIGNED: nobody answers for this report/);
  });

  test("a signed page from which the signature was taken", async () => {
    const { state } = await checkPage(pages.editedPage(pages.signedRun(), "stripped", (text) =>
      pages.changePart(text, "signature-files", () => "[]")));
    assert.equal(state, "unsigned");
  });

  test("signed by another program, without its key", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.foreignSignatureRun()));
    assert.equal(state, "unchecked", words);
    assert.match(words, /made by another program.*minisign -Vm/);
  });

  test("signed by a key of another type", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.ecdsaRun()));
    assert.equal(state, "unchecked", words);
    assert.match(words, /ecdsa-sha2-nistp256.*ssh-keygen -Y verify or runcert verify/);
  });

  for (const [name, before] of [
    ["that does not know Ed25519",
      "SubtleCrypto.prototype.importKey = async () => { throw new DOMException('', 'NotSupportedError'); };"],
    ["without WebCrypto", "Object.defineProperty(Crypto.prototype, 'subtle', { get: () => undefined });"],
  ])
    test(`in a browser ${name}`, async () => {
      const { state, words } = await checkPage(pages.pageOf(pages.signedRun()), { before });
      assert.equal(state, "unchecked", words);
      assert.match(words, /UNCHECKED/);
      assert.match(words, /cannot verify Ed25519/);
    });

  test("without scripts it shows everything and says that it was not checked", async () => {
    const file = pages.pageOf(pages.signedRun());
    const withScripts = await withPage(file, (page) => page.evaluate(() =>
      Array.from(document.querySelectorAll("main h2, main h3"), (heading) => heading.textContent)));
    await withPage(file, async (page) => {
      const shown = await page.locator("main").innerText();
      for (const heading of withScripts) assert.ok(shown.includes(heading), heading);
      const beside = await page.locator("body").innerText();
      assert.match(beside.replace(shown, ""), /has not checked its signatures/);
      const pictures = page.locator(".drawing svg");
      assert.equal(await pictures.count(), pages.reportOf(pages.signedRun()).predicate.figures.length);
      for (const picture of await pictures.all()) assert.ok(await picture.isVisible());
    }, { javaScriptEnabled: false });
  });
});
