#include "trust/time_stamp_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/text.h"
#include "trust/signature_text.h"

namespace runcert {
namespace {

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

std::string value_in_words(std::string_view text, std::string_view name) {
    for (const std::string_view line : signature_text::lines_of(text))
        if (line.starts_with(name)) return std::string(trim(line.substr(name.size())));
    return {};
}

StampedHash stamped_hash_from_words(std::string_view text) {
    return {.algorithm = value_in_words(text, "Hash Algorithm:"),
            .imprint = imprint_of(text),
            .nonce = value_in_words(text, "Nonce:")};
}

std::optional<TimeStamp> stamp_from_words(std::string_view text) {
    const auto time = read_openssl_time(value_in_words(text, "Time stamp:"));
    TimeStamp stamp{.hash = stamped_hash_from_words(text)};
    if (stamp.hash.imprint.empty() || !time) return std::nullopt;
    stamp.time = *time;
    return stamp;
}

}  // namespace runcert
