#include "stages/import/igc/header.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace runcert::igc {
namespace {

constexpr std::array<std::string_view, extensions> codes{"FXA", "VXA", "SIU", "TDS",
                                                         "LAD", "LOD", "GSP", "TRT"};
constexpr std::size_t first_extension = 36;  ///< byte of a B record, counted from 1
constexpr std::size_t most_digits = 9;       ///< so that they are a number below 2^31

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// The number of two digits at `at`; nothing where they are none.
std::optional<std::size_t> two_digits(std::string_view text, std::size_t at) {
    if (text.size() < at + 2 || !is_digit(text[at]) || !is_digit(text[at + 1])) return std::nullopt;
    return static_cast<std::size_t>((text[at] - '0') * 10 + (text[at + 1] - '0'));
}

void add_extension(Layout& layout, const Cell& record, std::size_t at) {
    const auto from = two_digits(record.text, at);
    const auto to = two_digits(record.text, at + 2);
    const std::string_view code = record.text.substr(at + 4, 3);
    if (!from || !to || *from < first_extension || *to < *from)
        record.fail(fmt::format("\"{}\" is no place of an extension of the B records",
                                escape_for_message(record.text.substr(at, 7))),
                    "Take the recording as the flight recorder wrote it");
    const auto known = std::find(codes.begin(), codes.end(), code);
    if (known == codes.end()) return;
    const std::size_t size = *to - *from + 1;
    if (size > most_digits)
        record.fail(fmt::format("the extension {} has {} digits", code, size),
                    "Take the recording as the flight recorder wrote it");
    layout.spans[static_cast<std::size_t>(known - codes.begin())] = {*from - 1, size};
    layout.record_bytes = std::max(layout.record_bytes, *to);
}

}  // namespace

Layout read_extensions(const Cell& record) {
    const std::string_view text = trim(record.text);
    const auto count = two_digits(text, 1);
    if (!count || text.size() != 3 + 7 * *count)
        record.fail(fmt::format("the I record \"{}\" does not hold as many extensions as it says",
                                escape_for_message(text)),
                    "Take the recording as the flight recorder wrote it");
    Layout layout;
    for (std::size_t i = 0; i < *count; ++i)
        add_extension(layout, record, 3 + 7 * i);
    return layout;
}

std::string_view header_code(std::string_view record) {
    if (record.size() < 5 || record[0] != 'H') return {};
    return record.substr(2, 3);
}

std::string_view header_text(std::string_view record) {
    const std::size_t colon = record.find(':');
    return trim(record.substr(
        colon == std::string_view::npos ? std::min(record.size(), std::size_t{5}) : colon + 1));
}

std::optional<Date> read_date(const Cell& record) {
    if (header_code(record.text) != "DTE") return std::nullopt;
    std::string_view text = header_text(record.text);
    if (text.starts_with("DATE")) text.remove_prefix(4);
    const auto day = two_digits(text, 0);
    const auto month = two_digits(text, 2);
    const auto year = two_digits(text, 4);
    const bool ended = text.size() == 6 || (text.size() > 6 && !is_digit(text[6]));
    if (!day || !month || !year || !ended)
        record.fail(fmt::format("\"{}\" is not a date", escape_for_message(record.text)),
                    "Dates are written HFDTE160701 or HFDTEDATE:160701,01: day, month, year");
    return Date{.year = static_cast<int>(*year) + (*year >= 80 ? 1900 : 2000),
                .month = static_cast<int>(*month),
                .day = static_cast<int>(*day)};
}

AltitudeReference read_altitude_reference(std::string_view record) {
    const std::string_view text = header_text(record);
    if (text.starts_with("ELL")) return AltitudeReference::ellipsoid;
    if (text.starts_with("GEO") || text.starts_with("MSL")) return AltitudeReference::geoid;
    if (text.starts_with("NIL")) return AltitudeReference::none;
    return AltitudeReference::not_stated;
}

}  // namespace runcert::igc
