#include "trust/ssh_signature.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "trust/signature_text.h"

namespace runcert {
namespace {

constexpr std::string_view ed25519_type = "ssh-ed25519";
constexpr std::array<std::string_view, 7> known_types{ed25519_type,
                                                      "ecdsa-sha2-nistp256",
                                                      "ecdsa-sha2-nistp384",
                                                      "ecdsa-sha2-nistp521",
                                                      "ssh-rsa",
                                                      "sk-ssh-ed25519@openssh.com",
                                                      "sk-ecdsa-sha2-nistp256@openssh.com"};

std::string wire_string(std::string_view bytes) {
    std::string text;
    for (const unsigned shift : {24U, 16U, 8U, 0U})
        text += static_cast<char>((bytes.size() >> shift) & 0xFFU);
    return text.append(bytes);
}

[[noreturn]] void refuse_key(const std::string& where, const std::string& what) {
    throw Failure(where, what,
                  "Copy the key whole, from the .pub file that ssh-keygen or runcert keygen made");
}

constexpr std::string_view armor_begin = "-----BEGIN SSH SIGNATURE-----";
constexpr std::string_view last_line = "-----END SSH SIGNATURE-----";
constexpr std::string_view magic = "SSHSIG";
constexpr std::string_view version_one("\0\0\0\1", 4);

[[noreturn]] void refuse_signature(const std::string& where, const std::string& what) {
    throw Failure(where, what, "Name a file that ssh-keygen -Y sign wrote, whole and unchanged");
}

/// Takes a string (RFC 4251 section 5) off the front of a wire format. Nothing where there are
/// fewer bytes than its length says.
std::optional<std::string_view> take_wire_string(std::string_view& rest) {
    if (rest.size() < 4) return std::nullopt;
    std::uint32_t length = 0;
    for (const char byte : rest.substr(0, 4))
        length = (length << 8U) | static_cast<unsigned char>(byte);
    if (rest.size() - 4 < length) return std::nullopt;
    const std::string_view taken = rest.substr(4, length);
    rest.remove_prefix(4 + std::size_t{length});
    return taken;
}

/// The key that a wire format holds. Failure where it does not hold one.
SshPublicKey ssh_key_of_blob(std::string blob, const std::string& where) {
    std::string_view rest = blob;
    const auto type = take_wire_string(rest);
    if (!type || rest.empty()) refuse_key(where, "this is not a public key of OpenSSH");
    if (!is_ssh_key_type(*type))
        refuse_key(where, fmt::format("keys of the type \"{}\" are not read here, only {}",
                                      escape_for_message(*type), ssh_key_types()));
    if (*type == ed25519_type) {
        const auto key = take_wire_string(rest);
        if (!key || key->size() != Ed25519Key().size() || !rest.empty())
            refuse_key(where, "this is not an Ed25519 key: it does not hold 32 bytes");
    }
    const std::string type_text(*type);
    return {type_text, std::move(blob)};
}

std::string blob_of(std::string_view text, const std::string& where) {
    const std::vector<std::string_view> lines = signature_text::lines_of(text);
    if (lines.size() < 3 || lines.front() != armor_begin || lines.back() != last_line)
        refuse_signature(
            where, fmt::format("this is not an ssh signature: it does not stand between \"{}\" "
                               "and \"{}\"",
                               armor_begin, last_line));
    std::string base64;
    for (std::size_t i = 1; i + 1 < lines.size(); ++i)
        base64.append(lines[i]);
    auto blob = decode_base64(base64);
    if (!blob) refuse_signature(where, "the lines of the ssh signature are not base64");
    return std::move(*blob);
}

std::string_view take(std::string_view& rest, const char* what, const std::string& where) {
    const auto taken = take_wire_string(rest);
    if (!taken) refuse_signature(where, fmt::format("the ssh signature ends before its {}", what));
    return *taken;
}

}  // namespace

bool is_ssh_key_type(std::string_view word) {
    return std::ranges::find(known_types, word) != known_types.end();
}

std::string ssh_key_types() {
    return fmt::format("{}", fmt::join(known_types, ", "));
}

SshPublicKey parse_ssh_public_key(std::string_view type, std::string_view base64,
                                  const std::string& where) {
    auto blob = decode_base64(base64);
    if (!blob || blob->empty())
        refuse_key(where, fmt::format("the word after {} is not a key: \"{}\"",
                                      escape_for_message(type), escape_for_message(base64)));
    SshPublicKey key = ssh_key_of_blob(std::move(*blob), where);
    if (key.type != type)
        refuse_key(where, fmt::format("the line says {}, its key is of the type {}",
                                      escape_for_message(type), key.type));
    return key;
}

SshPublicKey ssh_key_of(const Ed25519Key& key) {
    return {std::string(ed25519_type),
            wire_string(ed25519_type) +
                wire_string({reinterpret_cast<const char*>(key.data()), key.size()})};
}

std::optional<Ed25519Key> ed25519_of(const SshPublicKey& key) {
    if (key.type != ed25519_type) return std::nullopt;
    Ed25519Key bytes{};
    std::copy(key.blob.end() - static_cast<std::ptrdiff_t>(bytes.size()), key.blob.end(),
              bytes.begin());
    return bytes;
}

std::string ssh_key_text(const SshPublicKey& key) {
    return key.type + " " +
           signature_text::base64_of(signature_text::data_of(key.blob), key.blob.size());
}

std::string weakness_of(const SshPublicKey& key) {
    if (key.type != "ssh-rsa") return {};
    std::string_view rest = key.blob;
    (void)take_wire_string(rest);  // the type
    (void)take_wire_string(rest);  // the exponent
    std::string_view modulus = take_wire_string(rest).value_or("");
    modulus.remove_prefix(std::min(modulus.find_first_not_of('\0'), modulus.size()));
    if (modulus.empty()) return {};
    const auto bits =
        8 * modulus.size() -
        static_cast<std::size_t>(std::countl_zero(static_cast<unsigned char>(modulus.front())));
    return bits < least_rsa_bits ? fmt::format("RSA of {} bits", bits) : "";
}

std::string ssh_fingerprint(const SshPublicKey& key) {
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256(hash.data(), signature_text::data_of(key.blob), key.blob.size());
    std::string text = signature_text::base64_of(hash.data(), hash.size());
    while (text.ends_with('='))
        text.pop_back();
    return "SHA256:" + text;
}

SshSignature parse_ssh_signature(std::string_view text, const std::string& where) {
    const std::string blob = blob_of(text, where);
    std::string_view rest = blob;
    if (!rest.starts_with(magic))
        refuse_signature(where, "this is not an ssh signature: no \"SSHSIG\"");
    rest.remove_prefix(magic.size());
    if (!rest.starts_with(version_one))
        refuse_signature(where, "the ssh signature is of a version that is not known here");
    rest.remove_prefix(version_one.size());
    SshSignature signature;
    signature.key = ssh_key_of_blob(std::string(take(rest, "public key", where)), where);
    signature.name_space = take(rest, "namespace", where);
    if (!is_printable_ascii(signature.name_space))
        refuse_signature(where, "the namespace of the ssh signature is not printable text");
    (void)take(rest, "reserved field", where);
    signature.hash_algorithm = take(rest, "hash algorithm", where);
    if (signature.hash_algorithm != "sha256" && signature.hash_algorithm != "sha512")
        refuse_signature(
            where, fmt::format("the ssh signature is over a hash \"{}\" that is not known here",
                               escape_for_message(signature.hash_algorithm)));
    (void)take(rest, "signature", where);
    if (!rest.empty()) refuse_signature(where, "there are bytes behind the ssh signature");
    return signature;
}

SshCheck check_ssh_signature(const std::filesystem::path& signed_file,
                             const std::filesystem::path& signature_file,
                             std::string_view allowed_signers, const std::string& principal,
                             const std::string& name_space, UtcSecond time) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "allowed_signers", allowed_signers);
    write_file_atomically(folder.path() / "signature", read_handwritten(signature_file));
    ProcessResult result;
    try {
        result =
            run_external({.command = {"ssh-keygen", "-Y", "verify", "-f", "allowed_signers", "-I",
                                      principal, "-n", name_space,
                                      "-Overify-time=" + compact_text(time), "-s", "signature"},
                          .folder = folder.path(),
                          .standard_input = signed_file});
    } catch (const Failure& failure) {
        throw Failure(signature_file.string(),
                      "ssh signatures are checked by ssh-keygen, which cannot be started: " +
                          failure.problem(),
                      failure.remedy());
    }
    if (result.exit_status == 0) return {.valid = true};
    const std::string_view said = trim(result.errors.empty() ? result.output : result.errors);
    return {.valid = false, .said = escape_for_message(said, 200)};
}

}  // namespace runcert
