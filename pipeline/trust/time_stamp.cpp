#include "trust/time_stamp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/external_program.h"
#include "trust/time_stamp_words.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// Runs `openssl ts` in a folder, on files that lie elsewhere.
ProcessResult openssl_ts(std::vector<std::string> arguments, const fs::path& folder,
                         const std::vector<fs::path>& inputs = {}) {
    arguments.insert(arguments.begin(), {"openssl", "ts"});
    try {
        return run_external({.command = std::move(arguments), .folder = folder, .inputs = inputs});
    } catch (const Failure& failure) {
        throw Failure(
            "time stamps",
            "they are made and checked by openssl, which cannot be started: " + failure.problem(),
            failure.remedy());
    }
}

/// Whether bytes are one DER element (ITU-T X.690, 8.1.3) and nothing behind it, where openssl
/// would not look.
bool is_one_der_element(std::string_view bytes) {
    const auto byte_at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    if (bytes.size() < 2) return false;
    std::size_t header = 2;
    std::uint64_t length = byte_at(1);
    if (length >= 0x80) {
        const std::size_t count = length & 0x7FU;
        if (count == 0 || count > 4 || bytes.size() < 2 + count) return false;
        length = 0;
        for (std::size_t i = 0; i < count; ++i)
            length = length << 8U | byte_at(2 + i);
        header += count;
    }
    return bytes.size() == header + length;
}

/// The signed part of a reply. Only of this may the text be read: the status around it is not
/// signed, and could hold lines that look like its.
std::string token_of(const fs::path& reply, const fs::path& folder) {
    if (!is_one_der_element(read_handwritten(reply)))
        throw Failure(reply.string(), "this is not a reply of a time stamp authority",
                      "Give the file as the authority sent it, whole and nothing behind it");
    const fs::path given = external_input(reply);
    const ProcessResult taken = openssl_ts(
        {"-reply", "-in", given.string(), "-token_out", "-out", "token"}, folder, {given});
    if (taken.exit_status == 0 && fs::exists(folder / "token")) return "token";
    const ProcessResult shown =
        openssl_ts({"-reply", "-in", given.string(), "-text"}, folder, {given});
    const std::string status = value_in_words(shown.output, "Status:");
    if (shown.exit_status != 0 || status.empty())
        throw Failure(reply.string(), "this is not a reply of a time stamp authority",
                      "Give the file that the authority answered with (application/"
                      "timestamp-reply)");
    throw Failure(
        reply.string(),
        fmt::format("the authority gave no time stamp: {} {} {}", escape_for_message(status),
                    escape_for_message(value_in_words(shown.output, "Status description:"), 100),
                    escape_for_message(value_in_words(shown.output, "Failure info:"), 100)),
        "Send the query again, or to another authority");
}

TimeStamp read_token(const std::string& token, const fs::path& reply, const fs::path& folder) {
    const ProcessResult shown = openssl_ts({"-reply", "-in", token, "-token_in", "-text"}, folder);
    const auto stamp = stamp_from_words(shown.output);
    if (shown.exit_status != 0 || !stamp)
        throw Failure(reply.string(),
                      "the time stamp in it cannot be read: " + said_by_openssl(shown.errors),
                      "Give the file as the authority sent it, whole");
    return *stamp;
}

/// Whether nobody can make two files with one hash of that kind.
bool is_strong(std::string_view algorithm) {
    constexpr std::array<std::string_view, 6> strong{"sha256",   "sha384",   "sha512",
                                                     "sha3-256", "sha3-384", "sha3-512"};
    return std::ranges::find(strong, algorithm) != strong.end();
}

/// All certificates in one file, for openssl.
std::string joined_certificates(const std::vector<fs::path>& cas, const fs::path& folder) {
    std::string certificates;
    for (const fs::path& ca : cas) {
        const std::string text = read_handwritten(ca);
        if (text.find("-----BEGIN CERTIFICATE-----") == std::string::npos)
            throw Failure(ca.string(), "there is no certificate in PEM form in it",
                          "Give the certificate of the time stamp authority's root (PEM)");
        certificates += text + "\n";
    }
    write_file_atomically(folder / "ca.pem", certificates);
    return "ca.pem";
}

}  // namespace

std::string make_time_stamp_query(const fs::path& file) {
    const TemporaryFolder folder;
    const fs::path data = external_input(file);
    const ProcessResult made =
        openssl_ts({"-query", "-data", data.string(), "-sha512", "-cert", "-out", "query"},
                   folder.path(), {data});
    if (made.exit_status != 0)
        throw Failure(file.string(),
                      "no time stamp query can be made: " + said_by_openssl(made.errors),
                      "Check that the file can be read, and openssl's configuration");
    return read_file(folder.path() / "query");
}

StampedHash read_time_stamp_query(const fs::path& query) {
    (void)read_handwritten(query);
    const fs::path given = external_input(query);
    const ProcessResult shown = openssl_ts({"-query", "-in", given.string(), "-text"}, {}, {given});
    const StampedHash hash = stamped_hash_from_words(shown.output);
    if (shown.exit_status != 0 || hash.imprint.empty())
        throw Failure(query.string(), "this is not a time stamp query",
                      "Remove it, and let runcert timestamp write a new one");
    return hash;
}

TimeStamp read_time_stamp_reply(const fs::path& reply) {
    const TemporaryFolder folder;
    return read_token(token_of(reply, folder.path()), reply, folder.path());
}

TimeStampCheck check_time_stamp(const fs::path& file, const fs::path& reply,
                                const std::vector<fs::path>& cas) {
    const TemporaryFolder folder;
    const std::string certificates = joined_certificates(cas, folder.path());
    TimeStampCheck check;
    try {
        const std::string token = token_of(reply, folder.path());
        const TimeStamp stamp = read_token(token, reply, folder.path());
        check.time = stamp.time;
        if (!is_strong(stamp.hash.algorithm)) {
            check.reason = fmt::format("it is over a {} hash, which another file can share",
                                       escape_for_message(stamp.hash.algorithm));
            return check;
        }
        const fs::path data = external_input(file);
        const ProcessResult verified = openssl_ts(
            {"-verify", "-data", data.string(), "-in", token, "-token_in", "-CAfile", certificates,
             "-attime", std::to_string(check.time.time_since_epoch().count())},
            folder.path(), {data});
        check.valid = verified.exit_status == 0 && verified.output == "Verification: OK\n";
        if (!check.valid) check.reason = said_by_openssl(verified.errors);
    } catch (const Failure& failure) {
        if (failure.where() != reply.string()) throw;
        check.reason = failure.problem();
    }
    return check;
}

}  // namespace runcert
