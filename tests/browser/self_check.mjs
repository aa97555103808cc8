// The page checks itself: what it says of whole, changed, unsigned and foreign pages.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { describe, test } from "node:test";
import { checkPage, outcomeOf, withPage } from "./browser.mjs";
import * as pages from "./pages.mjs";
import { isStudy, run, workFolder } from "./programs.mjs";

async function expectTampered(file, words, options) {
  const outcome = await checkPage(file, options);
  assert.equal(outcome.state, "tampered", outcome.words);
  assert.match(outcome.words, /DO NOT TRUST THIS PAGE/);
  assert.match(outcome.words, words);
  assert.doesNotMatch(outcome.words, /shows what was signed/);
}

/** The line of an OpenSSH public key with the 32 bytes of a minisign key. */
function sshLineOf(minisignLine) {
  const string = (bytes) => Buffer.concat([Buffer.from([0, 0, 0, bytes.length]), bytes]);
  const bytes = Buffer.from(minisignLine, "base64").subarray(10);
  return `ssh-ed25519 ${Buffer.concat([string(Buffer.from("ssh-ed25519")), string(bytes)]).toString("base64")}\n`;
}

const fingerprintOf = (file) => run("ssh-keygen", "-l", "-f", file).split(" ")[1];

describe("a signed page", () => {
  test("says that it shows what was signed, by which key, and who decides", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.signedRun()));
    assert.equal(state, "valid", words);
    const { line } = pages.key("measurer");
    const sshFile = path.join(workFolder, "measurer-as-ssh.pub");
    fs.writeFileSync(sshFile, sshLineOf(line));
    const comment = fs.readFileSync(pages.key("measurer").public, "utf8").split("\n")[0];
    assert.ok(words.includes(line), "the public key");
    assert.ok(words.includes(fingerprintOf(sshFile)), "the fingerprint that ssh-keygen gives");
    assert.ok(words.includes(/[0-9A-F]{16}/.exec(comment)[0]), "the key id");
    assert.match(words, /This page shows what was signed/);
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

  test("one digit of the speed", async () => {
    const speed = pages.headlineOf(pages.beatenRun()).text;
    const false_speed = pages.anotherLetter(speed[0]) + speed.slice(1);
    const file = pages.editedPage(pages.beatenRun(), "speed", (text) => pages.changeMain(text, (main) =>
      main.replace(speed, false_speed)));
    await expectTampered(file, new RegExp(`${false_speed}.* where .*${speed}.* was signed`));
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

  test("any letter of its text", async () => {
    // Places spread over the page by a linear congruential generator (Numerical Recipes, 7.1). A part
    // of the page that is not compared and holds half of its letters is found by four with probability
    // 0.94, one that holds a fifth by fifteen with 0.96.
    let state = 20260314;
    for (let round = 0; round < (isStudy ? 15 : 4); ++round) {
      const file = edited(`letter-${round}`, (text) => pages.changeMain(text, (main) => {
        const places = [...main.replace(/<[^>]*>|&[a-z#0-9]+;|\s/g, (skipped) => "\0".repeat(skipped.length))
          .matchAll(/[^\0]/g)].map(({ index }) => index);
        state = (1664525 * state + 1013904223) % 2 ** 32;
        const at = places[Math.floor(state / 2 ** 32 * places.length)];
        return main.slice(0, at) + pages.anotherLetter(main[at]) + main.slice(at + 1);
      }));
      await expectTampered(file, /is other than it was made/);
    }
  });

  test("a row of a table left out", async () => {
    await expectTampered(edited("row", (text) => pages.changeMain(text, (main) => main.replace(/<tr[^>]*>[^]*?<\/tr>/, ""))),
      /is other than it was made/);
  });

  test("text beside the report", async () => {
    await expectTampered(edited("beside", (text) => text.replace("<main", "<p>Checked by the board.</p><main")),
      /Checked by the board/);
    await expectTampered(edited("box", (text) => text.replace(/(id="self-check"[^>]*>)/, "$1This page is valid")),
      /This page is valid/);
  });

  test("an attribute that hides a part of it", async () => {
    await expectTampered(edited("hidden-main", (text) => text.replace("<main ", "<main style=\"color: transparent\" ")),
      /is other than it was made/);
    await expectTampered(edited("hidden", (text) => pages.changeMain(text, (main) => main.replace(/<p\b/, "<p hidden"))),
      /is other than it was made/);
  });

  test("one digit of the report inside it", async () => {
    await expectTampered(edited("json", (text) => pages.changePart(text, "report-json", (json) =>
      json.replace(/("speed_m_s": ?\d)(\d)/, (all, begin, digit) => begin + pages.anotherLetter(digit)))),
    /report\.json\.minisig: the signature of report\.json does not hold/);
  });

  test("white space in the report inside it", async () => {
    await expectTampered(edited("space", (text) => pages.changePart(text, "report-json", (json) => json + " ")),
      /the signature of report\.json does not hold/);
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

  test("a drawing", async () => {
    const changePicture = (change) => (text) => pages.changeMain(text, (main) => {
      const [picture, source] = /<img[^>]* src="(data:image\/svg[^"]*)"/.exec(main);
      return main.replace(picture, picture.replace(source, change(source)));
    });
    const swapped = (source) => source.slice(0, 400) + pages.anotherLetter(source[400]) + source.slice(401);
    await expectTampered(edited("drawing", changePicture(swapped)), /drawing 1 was changed/);
    await expectTampered(edited("over", (text) => pages.changeMain(text, (main) =>
      main.replace("<div class=\"drawing\">", "<div class=\"drawing\">99 km/h"))), /“99 km\/h/);
  });

  test("the signed report of another attempt under this text", async () => {
    const other = fs.readFileSync(pages.pageOf(pages.rejectedRun()), "utf8");
    const taken = (text, id) => pages.changePart(text, id, () => pages.partOf(other, id));
    await expectTampered(edited("replaced", (text) => taken(taken(text, "report-json"), "signature-files")),
      /is other than it was made/);
    await expectTampered(edited("replayed", (text) => taken(text, "signature-files")),
      /a signature of another report/);
  });

  test("trouble in the check itself is not silent", async () => {
    await expectTampered(pages.pageOf(pages.signedRun()), /could not be finished: broken/,
      { before: "DOMParser.prototype.parseFromString = () => { throw new Error('broken'); };" });
  });
});

// Daily every second. `verify` compares the page with the one that it renders itself, byte by byte:
// daily it is asked of every eighth.
describe("a page that shows something else while it carries the signed report", () => {
  for (const [index, [name, change]] of Object.entries(pages.lies).entries()) {
    if (!isStudy && index % 2 === 1) continue;
    test(`${name}: red, and refused by verify`, async () => {
      const file = pages.editedPage(pages.beatenRun(), `lie-${name.replaceAll(/\W+/g, "-")}`, change);
      const { state, words, shown } = await withPage(file, async (page) =>
        ({ ...await outcomeOf(page), shown: await page.locator("main#report").innerText() }), { refusing: true });
      assert.equal(state, "tampered", words);
      assert.ok(shown.includes(pages.headlineOf(pages.beatenRun()).text), "what was signed is shown under the warning");
      assert.doesNotMatch(shown, /299\.99/);
      if (isStudy || index % 8 === 0) assert.match(pages.verifyWithPage(pages.beatenRun(), file), /^NO +pages/m);
    });
  }

  test("one whose script the browser refuses says that it has not checked itself", async () => {
    const file = pages.editedPage(pages.signedRun(), "refused", (text) =>
      text.replace("charset=\"utf-8\"", "charset=\"windows-1252\""));
    const { state, words } = await checkPage(file, { refusing: true });
    assert.equal(state, undefined);
    assert.match(words, /has not checked itself/);
  });

  test("a standing for no place of the report, or of another kind, changes nothing", async () => {
    const block = { kind: "headline", text: "299.99 km/h ± 0.01 km/h" };
    const file = pages.editedPage(pages.beatenRun(), "no-place", (text) => pages.changePart(text, "standing", () =>
      pages.standingOf({ praise: { ...block, slot: "praise" }, "outcome/nalsa": { ...block, slot: "outcome/nalsa" } })));
    const { state, words, shown } = await withPage(file, async (page) =>
      ({ ...await outcomeOf(page), shown: await page.locator("main#report").innerText() }));
    assert.equal(state, "valid", words);
    assert.match(words, /shows what was signed, and a standing that was not/);
    assert.match(words, /without a roster of keys/);
    assert.doesNotMatch(shown, /299\.99/);
  });

  // Whoever signs can put them there; the program's own schema refuses them.
  test("members that no block has reach no template", async () => {
    const markup = "<b class=\"taken\">checked</b>";
    const file = pages.editedPage(pages.beatenRun(), "extra", (text) => pages.changePart(text, "report-json", (json) => {
      const report = JSON.parse(json);
      for (const section of report.predicate.document.sections) {
        Object.assign(section, { code_image: markup, image: markup, has_contents: true });
        for (const block of section.blocks) Object.assign(block, { is_check: true, code_image: markup, image: markup });
      }
      return JSON.stringify(report).replace(/[<>&]/g, (letter) => `\\u00${letter.charCodeAt(0).toString(16)}`);
    }));
    await withPage(file, async (page) => {
      const { state, words } = await outcomeOf(page);
      assert.equal(state, "tampered", words);
      assert.equal(await page.locator(".taken").count(), 0);
      assert.equal(await page.locator(".to-check").count(), 1);
      assert.equal(await page.locator("main nav").count(), 1);
    });
  });

  test("the same page unchanged is believed by both", async () => {
    assert.match(pages.verifyWithPage(pages.beatenRun(), pages.pageOf(pages.beatenRun()), 0), /^yes +pages/m);
  });
});

describe("a page that nobody signed, or whose signature it cannot check", () => {
  test("unsigned", async () => {
    const { state, words } = await checkPage(pages.pageOf(pages.unsignedRun()));
    assert.equal(state, "unsigned", words);
    assert.match(words, /UNSIGNED: nobody answers for this report/);
  });

  test("unsigned and changed", async () => {
    await expectTampered(pages.editedPage(pages.unsignedRun(), "unsigned", (text) => pages.changeMain(text, (main) =>
      main.replace("measurer", "director"))), /is other than it was made/);
  });

  test("a signed page from which the signature was taken", async () => {
    await expectTampered(pages.editedPage(pages.signedRun(), "stripped", (text) =>
      pages.changePart(text, "signature-files", () => "[]")), /is other than it was made/);
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
      await expectTampered(pages.editedPage(pages.signedRun(), "old-browser", (text) => pages.changeMain(text, (main) =>
        main.replace("measurer", "director"))), /is other than it was made/, { before });
    });

  test("without scripts it shows everything and says that it was not checked", async () => {
    const file = pages.pageOf(pages.signedRun());
    const withScripts = await withPage(file, (page) => page.evaluate(() =>
      Array.from(document.querySelectorAll("main h2, main h3"), (heading) => heading.textContent)));
    await withPage(file, async (page) => {
      const shown = await page.locator("main").innerText();
      for (const heading of withScripts) assert.ok(shown.includes(heading), heading);
      const beside = await page.locator("body").innerText();
      assert.match(beside.replace(shown, ""), /not checked itself|cannot check itself/);
      const pictures = page.locator(".drawing img");
      assert.equal(await pictures.count(), pages.reportOf(pages.signedRun()).predicate.figures.length);
      for (const picture of await pictures.all()) assert.ok(await picture.isVisible());
    }, { javaScriptEnabled: false });
  });
});
