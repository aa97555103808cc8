"use strict";
// Signature files: minisign's (https://jedisct1.github.io/minisign/) and OpenSSH's (PROTOCOL.sshsig).

/** What a signature file cannot be, in words for the reader. */
class PageFault extends Error {}

/** PageFault where a condition does not hold. */
function demand(holds, words) {
  if (!holds) throw new PageFault(words);
}

const joinBytes = (...parts) => Uint8Array.from(parts.flatMap((part) => Array.from(part)));
const utf8Bytes = (text) => new TextEncoder().encode(text);
const asciiText = (bytes) => String.fromCharCode(...bytes);
const base64Of = (bytes) => btoa(asciiText(bytes));
const hexOf = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");

/** The bytes of a line of base64 (RFC 4648 section 4, padded, no unused bits set). */
function bytesOfBase64(text, what) {
  let binary = "";
  try {
    binary = atob(text);
  } catch (error) { /* it stays empty */ }
  demand(binary !== "" && btoa(binary) === text, `its ${what} is not base64`);
  return Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
}

/** An SSH string (RFC 4251 section 5): its length in 4 bytes, then the bytes. */
const sshString = (bytes) =>
  joinBytes([24, 16, 8, 0].map((shift) => (bytes.length >>> shift) & 255), bytes);

/** Takes bytes, numbers of 4 bytes and SSH strings off some bytes, one after another. */
function sshReader(bytes) {
  let at = 0;
  const take = (count) => {
    demand(at + count <= bytes.length, "it ends too early");
    at += count;
    return bytes.subarray(at - count, at);
  };
  const number = () => take(4).reduce((sum, byte) => sum * 256 + byte, 0);
  return { take, number, string: () => take(number()) };
}

/** `SHA256:...` of a public key's SSH blob, as `ssh-keygen -l` prints it. */
const sshFingerprint = (blob) => "SHA256:" + base64Of(nobleHashes.sha256(blob)).replace(/=+$/, "");

/** A minisign key id as people write it: most significant byte first. */
const keyIdText = (id) => hexOf(Uint8Array.from(id).reverse()).toUpperCase();

/**
 * report, attempt, role, key and signed of a trusted comment of runcert; empty for any other.
 * PageFault where one is there twice: programs differ in which of the two they read.
 */
function commentFields(comment) {
  const [program, ...words] = comment.split(" ");
  const fields = Object.create(null);
  if (program !== "runcert") return fields;
  for (const word of words) {
    const equals = word.indexOf("=");
    if (equals <= 0) continue;
    const name = word.slice(0, equals);
    demand(!(name in fields), `its trusted comment states “${name}=” twice`);
    fields[name] = word.slice(equals + 1);
  }
  return fields;
}

/** The parts of a minisign signature file. PageFault where it is none. */
function readMinisign(text) {
  const lines = text.split("\n").map((line) => line.replace(/\r$/, ""));
  while (lines.length > 0 && lines[lines.length - 1] === "") lines.pop();
  demand(lines.length === 4 && lines[0].startsWith("untrusted comment: ") &&
    lines[2].startsWith("trusted comment: "), "it is not a signature file of minisign");
  const bytes = bytesOfBase64(lines[1], "second line");
  const global = bytesOfBase64(lines[3], "last line");
  demand(bytes.length === 74 && global.length === 64, "its signature has not the right length");
  const comment = lines[2].slice("trusted comment: ".length);
  return {
    algorithm: asciiText(bytes.subarray(0, 2)),
    keyId: keyIdText(bytes.subarray(2, 10)),
    signature: bytes.subarray(10),
    global,
    comment,
    fields: commentFields(comment),
  };
}

/** The parts of an OpenSSH signature. PageFault where it is none. */
function readSshSignature(text) {
  const armour = /^-----BEGIN SSH SIGNATURE-----\r?\n([A-Za-z0-9+/=\r\n]+)-----END SSH SIGNATURE-----\s*$/;
  const match = armour.exec(text);
  demand(match, "it is not a signature of ssh-keygen");
  const reader = sshReader(bytesOfBase64(match[1].replace(/[\r\n]/g, ""), "text"));
  demand(asciiText(reader.take(6)) === "SSHSIG" && reader.number() === 1,
    "it is not a signature of ssh-keygen in the form that this page knows");
  const blob = reader.string();
  const namespace = asciiText(reader.string());
  const reserved = reader.string();
  const hash = asciiText(reader.string());
  const signature = sshReader(reader.string());
  const key = sshReader(blob);
  const type = asciiText(key.string());
  return {
    blob, namespace, reserved, hash, type,
    key: type === "ssh-ed25519" ? key.string() : null,
    signatureType: asciiText(signature.string()),
    signature: signature.string(),
  };
}

/** Whether a signature holds; a key that is none makes it not hold. */
async function ed25519Holds(key, signature, message) {
  try {
    const imported = await crypto.subtle.importKey("raw", key, { name: "Ed25519" }, false, ["verify"]);
    return await crypto.subtle.verify({ name: "Ed25519" }, imported, signature, message);
  } catch (error) {
    return false;
  }
}

/** Whether this browser verifies Ed25519: asked with the first test vector of RFC 8032, 7.1. */
async function browserKnowsEd25519() {
  if (!globalThis.crypto || !crypto.subtle) return false;
  const bytes = (hex) => Uint8Array.from(hex.match(/../g), (pair) => parseInt(pair, 16));
  const key = bytes("d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a");
  const signature = bytes("e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e06522490155" +
                          "5fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe24655141438e7a100b");
  return ed25519Holds(key, signature, new Uint8Array(0));
}

const notHeld = "the signature of report.json does not hold: the report or the signature was changed";

/** Who signed; or, with `words`, why that cannot be checked. PageFault where it does not hold. */
async function minisignSigner(file, text, reportBytes, identity) {
  const read = readMinisign(text);
  const { report, attempt, role, key: line, signed: time } = read.fields;
  demand(read.algorithm === "ED", "it is not of minisign’s prehashed form");
  if (line === undefined)
    return { words: "It was made by another program and names no key: " +
      `check it with minisign -Vm report.json -x ${file} -p KEY.pub.` };
  const named = bytesOfBase64(line, "key");
  demand(named.length === 42 && asciiText(named.subarray(0, 2)) === "Ed",
    "the key that it names is not a minisign key");
  demand(keyIdText(named.subarray(2, 10)) === read.keyId, "it names another key than it was made with");
  const key = named.subarray(10);
  demand(report === identity.report && attempt === identity.attempt,
    `it is a signature of another report (report ${report}, attempt ${attempt})`);
  demand(await ed25519Holds(key, read.signature, nobleHashes.blake2b(reportBytes, { dkLen: 64 })), notHeld);
  demand(await ed25519Holds(key, read.global, joinBytes(read.signature, utf8Bytes(read.comment))),
    "its trusted comment (role, time, key) was changed");
  const blob = joinBytes(sshString(utf8Bytes("ssh-ed25519")), sshString(key));
  return { role, time, keyId: read.keyId, fingerprint: sshFingerprint(blob), publicKey: line };
}

async function sshSigner(text, reportBytes) {
  const read = readSshSignature(text);
  const role = /^([A-Za-z0-9_-]+)@runcert$/.exec(read.namespace)?.[1];
  demand(role, `it was not made for a report of runcert (its namespace is “${read.namespace}”)`);
  if (read.type !== "ssh-ed25519")
    return { words: `Its key is of the type ${read.type}, which a page cannot check: check it with ` +
      "ssh-keygen -Y verify or runcert verify." };
  const hashes = { sha256: nobleHashes.sha256, sha512: nobleHashes.sha512 };
  demand(Object.hasOwn(hashes, read.hash) && read.signatureType === "ssh-ed25519" && read.key.length === 32,
    "its parts do not fit together");
  const signed = joinBytes(utf8Bytes("SSHSIG"), sshString(utf8Bytes(read.namespace)), sshString(read.reserved),
    sshString(utf8Bytes(read.hash)), sshString(hashes[read.hash](reportBytes)));
  demand(await ed25519Holds(read.key, read.signature, signed), notHeld);
  return { role, fingerprint: sshFingerprint(read.blob), publicKey: `${read.type} ${base64Of(read.blob)}` };
}

/**
 * What is known of one signature file beside the bytes of report.json: {file, state, words} and, where
 * its state is "valid" and not "invalid" or "unchecked", who signed. `identity` is what the report says
 * of itself: {report, attempt}. Never throws for what stands in the file.
 */
async function checkSignature({ file, text }, reportBytes, identity) {
  try {
    const signer = await (text.startsWith("-----BEGIN SSH SIGNATURE-----")
      ? sshSigner(text, reportBytes) : minisignSigner(file, text, reportBytes, identity));
    return { file, state: signer.words ? "unchecked" : "valid", ...signer };
  } catch (error) {
    if (!(error instanceof PageFault)) throw error;
    return { file, state: "invalid", words: error.message };
  }
}
