#include "trust/signature.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/failure.h"
#include "core/text.h"
#include "trust/signature_text.h"

namespace runcert {
namespace signature_text {

void start_libsodium() {
    // A negative status means that the system has no random source.
    if (sodium_init() < 0)
        throw Failure("libsodium", "cannot start the cryptographic library",
                      "Check that the system has a random source (/dev/urandom)");
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(line);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    while (!lines.empty() && lines.back().empty())
        lines.pop_back();
    return lines;
}

std::string bytes_of_base64(std::string_view line, std::size_t count, const std::string& what,
                            const std::string& where) {
    const std::string remedy = "Use the file as it was made, whole and unchanged";
    auto bytes = decode_base64(line);
    if (!bytes) throw Failure(where, "the line of " + what + " is not base64", remedy);
    if (bytes->size() != count)
        throw Failure(where,
                      "the line of " + what + " holds " + std::to_string(bytes->size()) +
                          " bytes where " + std::to_string(count) + " are expected",
                      remedy);
    return std::move(*bytes);
}

}  // namespace signature_text

namespace {

using namespace signature_text;

constexpr std::size_t signature_size = 64;
constexpr std::size_t signature_record_size = 74;  // "ED", id (8), signature (64)
constexpr std::size_t longest_trusted_comment = 8000;
constexpr std::string_view known_untrusted_comments[] = {"signature from runcert secret key",
                                                         "signature from minisign secret key",
                                                         "signature from rsign secret key"};

/// A signature file taken apart.
struct ParsedSignature {
    std::string algorithm;  // "ED", or "Ed" for the legacy form
    PublicKey signer;       // its id alone; the file does not hold the key
    std::string signature;
    std::string trusted_comment;
    std::string comment_signature;
};

std::array<unsigned char, 64> blake2b_512(std::string_view message) {
    std::array<unsigned char, 64> hash{};
    crypto_generichash(hash.data(), hash.size(), data_of(message), message.size(), nullptr, 0);
    return hash;
}

void require_comment(std::string_view comment) {
    if (comment.size() > longest_trusted_comment || !is_printable_line(comment))
        throw Failure("the trusted comment of a signature",
                      fmt::format("it is not one line of printable text of at most {} bytes",
                                  longest_trusted_comment),
                      "Leave out line breaks and control characters, or shorten it");
}

ParsedSignature parse_signature_file(std::string_view text, const std::string& where) {
    const std::string remedy = "Name the .minisig file that belongs to the signed file";
    if (text.find('\r') != std::string_view::npos || text.ends_with("\n\n") ||
        !text.ends_with('\n'))
        throw Failure(where, "its lines do not end as a signer writes them",
                      "Take the original: four lines that end with a line feed alone");
    const std::vector<std::string_view> lines = lines_of(text);
    if (lines.size() != 4)
        throw Failure(where,
                      "this is not a signature file: it has " + std::to_string(lines.size()) +
                          " lines where four are expected",
                      remedy);
    if (!lines[0].starts_with(untrusted_prefix))
        throw Failure(where + ", line 1",
                      "it does not begin with \"" + std::string(untrusted_prefix) + "\"", remedy);
    // Nobody signs this line, so that no word of a signer's own may stand in it.
    if (std::ranges::find(known_untrusted_comments, lines[0].substr(untrusted_prefix.size())) ==
        std::end(known_untrusted_comments))
        throw Failure(where + ", line 1", "it is not the comment of runcert, minisign or rsign",
                      fmt::format("Nobody signs this line. Write \"{}{}\" in its place",
                                  untrusted_prefix, known_untrusted_comments[1]));
    if (!lines[2].starts_with(trusted_prefix))
        throw Failure(where + ", line 3",
                      "it does not begin with \"" + std::string(trusted_prefix) + "\"", remedy);
    ParsedSignature file;
    const std::string record =
        bytes_of_base64(lines[1], signature_record_size, "the signature", where + ", line 2");
    file.algorithm = record.substr(0, 2);
    if (file.algorithm != "ED" && file.algorithm != "Ed")
        throw Failure(where + ", line 2", "this is no Ed25519 signature of minisign's", remedy);
    std::copy_n(record.begin() + 2, file.signer.key_id.size(), file.signer.key_id.begin());
    file.signature = record.substr(10);
    file.trusted_comment = lines[2].substr(trusted_prefix.size());
    if (!is_printable_line(file.trusted_comment))
        throw Failure(where + ", line 3", "the trusted comment is not printable text", remedy);
    file.comment_signature = bytes_of_base64(lines[3], signature_size,
                                             "the trusted comment's signature", where + ", line 4");
    return file;
}

bool comment_holds(const ParsedSignature& file, const PublicKey& public_key) {
    const std::string signed_comment = file.signature + file.trusted_comment;
    return crypto_sign_verify_detached(data_of(file.comment_signature), data_of(signed_comment),
                                       signed_comment.size(), public_key.key.data()) == 0;
}

/// Why the signature is not this key's over this message; empty where it is.
std::string find_fault(std::string_view message, const ParsedSignature& file,
                       const PublicKey& public_key) {
    if (file.algorithm == "Ed")
        return "it is in minisign's legacy format without prehashing, which is not accepted: "
               "sign again without -l";
    if (file.signer.key_id != public_key.key_id)
        return "it was made with the key " + key_id_text(file.signer) + ", not with the key " +
               key_id_text(public_key) + " that was given";
    const std::array<unsigned char, 64> hash = blake2b_512(message);
    if (crypto_sign_verify_detached(data_of(file.signature), hash.data(), hash.size(),
                                    public_key.key.data()) != 0)
        return "the signed file is not as it was when it was signed, or the signature is not the "
               "key's";
    if (!comment_holds(file, public_key))
        return "the trusted comment is not as it was when it was signed";
    return {};
}

constexpr std::string_view mark = "runcert";

constexpr std::array<std::pair<std::string_view, std::string TrustedComment::*>, 6> fields{{
    {"report", &TrustedComment::report_id},
    {"attempt", &TrustedComment::attempt_id},
    {"role", &TrustedComment::role},
    {"key", &TrustedComment::key},
    {"signed", &TrustedComment::signed_at},
    {"recomputed", &TrustedComment::recomputed},
}};

}  // namespace

std::string sign(std::string_view message, const SecretKey& secret_key,
                 std::string_view trusted_comment) {
    start_libsodium();
    require_comment(trusted_comment);

    const std::array<unsigned char, 64> hash = blake2b_512(message);
    std::array<unsigned char, signature_record_size> record{'E', 'D'};
    std::copy(secret_key.key_id().begin(), secret_key.key_id().end(), record.begin() + 2);
    unsigned char* signature = record.data() + 10;
    crypto_sign_detached(signature, nullptr, hash.data(), hash.size(), secret_key.bytes().data());

    std::string signed_comment(record.begin() + 10, record.end());
    signed_comment += trusted_comment;
    std::array<unsigned char, signature_size> comment_signature{};
    crypto_sign_detached(comment_signature.data(), nullptr, data_of(signed_comment),
                         signed_comment.size(), secret_key.bytes().data());

    std::string text;
    text.append(untrusted_prefix).append(known_untrusted_comments[0]) += '\n';
    text.append(base64_of(record.data(), record.size())) += '\n';
    text.append(trusted_prefix).append(trusted_comment) += '\n';
    text.append(base64_of(comment_signature.data(), comment_signature.size())) += '\n';
    return text;
}

SignatureCheck check_signature(std::string_view message, std::string_view signature_file_text,
                               const PublicKey& public_key, const std::string& where) {
    start_libsodium();
    ParsedSignature file = parse_signature_file(signature_file_text, where);
    SignatureCheck check;
    check.key_id = key_id_text(file.signer);
    check.reason = find_fault(message, file, public_key);
    check.valid = check.reason.empty();
    if (check.valid) check.trusted_comment = file.trusted_comment;
    if (comment_holds(file, public_key)) check.vouched_comment = std::move(file.trusted_comment);
    return check;
}

SignatureClaims read_signature_claims(std::string_view signature_file_text,
                                      const std::string& where) {
    start_libsodium();
    ParsedSignature file = parse_signature_file(signature_file_text, where);
    return {file.signer.key_id, std::move(file.trusted_comment)};
}

std::string trusted_comment_text(const TrustedComment& comment) {
    std::string text(mark);
    for (const auto& [name, member] : fields)
        if (member != &TrustedComment::recomputed || !comment.recomputed.empty())
            text += fmt::format(" {}={}", name, comment.*member);
    return text;
}

TrustedComment parse_trusted_comment(std::string_view text) {
    TrustedComment comment;
    std::set<std::string_view> seen;
    const auto take_word = [&text] {
        const std::string_view word = text.substr(0, text.find(' '));
        text.remove_prefix(std::min(word.size() + 1, text.size()));
        return word;
    };
    if (take_word() != mark) return comment;
    while (!text.empty()) {
        const std::string_view word = take_word();
        const std::size_t equals = std::min(word.find('='), word.size());
        for (const auto& [name, member] : fields)
            if (word.substr(0, equals) == name && equals < word.size()) {
                if (!seen.insert(name).second) comment.repeated = name;
                comment.*member = word.substr(equals + 1);
            }
    }
    return comment;
}

}  // namespace runcert
