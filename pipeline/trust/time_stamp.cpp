#include "trust/time_stamp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "trust/signature_text.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// The hash in openssl's dump: "    0000 - e7 c2 ... d9 cf-2b 48 ...   text".
std::string imprint_of(std::string_view text) {
    constexpr std::size_t digits_begin = 11;
    constexpr std::size_t digits_end = digits_begin + 16 * 3;
    std::string imprint;
    bool inside = false;
    for (const std::string_view line : signature_text::lines_of(text)) {
        if (inside && !line.starts_with("    ")) break;
        if (inside && line.size() > digits_begin)
            for (const char c : line.substr(digits_begin, digits_end - digits_begin))
                if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')) imprint += c;
        inside = inside || line.starts_with("Message data:");
    }
    return imprint;
}

/// What follows "NAME:" on the first line that begins with it; empty where there is none.
std::string value_in_words(std::string_view text, std::string_view name) {
    for (const std::string_view line : signature_text::lines_of(text))
        if (line.starts_with(name)) return std::string(trim(line.substr(name.size())));
    return {};
}

/// What a query or token is for; fields that are not there are empty.
StampedHash stamped_hash_from_words(std::string_view text) {
    return {.algorithm = value_in_words(text, "Hash Algorithm:"),
            .imprint = imprint_of(text),
            .nonce = value_in_words(text, "Nonce:")};
}

/// "Nov 21 20:59:25 2026 GMT", seconds with or without decimals.
std::optional<UtcSecond> read_openssl_time(std::string_view text) {
    constexpr std::array<std::string_view, 12> months{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    std::string plain(text);
    if (const std::size_t point = plain.find('.'); point != std::string::npos)
        plain.erase(point, std::min(plain.find(' ', point), plain.size()) - point);
    if (plain.size() != 24 || !plain.ends_with(" GMT")) return std::nullopt;
    const auto month = std::ranges::find(months, plain.substr(0, 3));
    std::string day = plain.substr(4, 2);
    if (day[0] == ' ') day[0] = '0';
    return parse_iso_utc(fmt::format("{}-{:02}-{}T{}Z", plain.substr(16, 4),
                                     month - months.begin() + 1, day, plain.substr(7, 8)));
}

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

std::string said_by_openssl(std::string_view errors) {
    std::string said = "openssl gives no reason";
    for (const std::string_view line : signature_text::lines_of(errors))
        // PROCESS:error:CODE:LIBRARY:FUNCTION:REASON:FILE:LINE:DETAILS
        if (line.find(":error:") != std::string_view::npos) {
            std::vector<std::string_view> fields;
            for (std::string_view rest = line; fields.size() < 8;) {
                const std::size_t end = std::min(rest.find(':'), rest.size());
                fields.push_back(rest.substr(0, end));
                rest.remove_prefix(std::min(end + 1, rest.size()));
                if (fields.size() == 8) fields.push_back(rest);
            }
            said = escape_for_message(fields[5], 100);
            if (!fields[8].empty()) said += ": " + escape_for_message(fields[8], 150);
            break;
        }
    return said;
}

std::optional<TimeStamp> stamp_from_words(std::string_view text) {
    const auto time = read_openssl_time(value_in_words(text, "Time stamp:"));
    TimeStamp stamp{.hash = stamped_hash_from_words(text)};
    if (stamp.hash.imprint.empty() || !time) return std::nullopt;
    stamp.time = *time;
    return stamp;
}

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
