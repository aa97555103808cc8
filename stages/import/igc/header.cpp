#include "stages/import/igc/header.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/day_clock.h"

namespace runcert::igc {
namespace {

constexpr std::array<std::string_view, extensions> codes{"FXA", "VXA", "SIU", "TDS",
                                                         "LAD", "LOD", "GSP", "TRT"};
constexpr int first_extension = 36;  ///< byte of a B record, counted from 1
constexpr int most_digits = 9;       ///< so that they are a number below 2^31

void add_extension(Layout& layout, const Cell& record, std::size_t at) {
    const auto from = digits_at(record.text, at, 2);
    const auto to = digits_at(record.text, at + 2, 2);
    const std::string_view code = record.text.substr(at + 4, 3);
    if (!from || !to || *from < first_extension || *to < *from)
        record.fail(fmt::format("\"{}\" is no place of an extension of the B records",
                                escape_for_message(record.text.substr(at, 7))),
                    "Take the recording as the flight recorder wrote it");
    const auto known = std::find(codes.begin(), codes.end(), code);
    if (known == codes.end()) return;
    const int size = *to - *from + 1;
    if (size > most_digits)
        record.fail(fmt::format("the extension {} has {} digits", code, size),
                    "Take the recording as the flight recorder wrote it");
    layout.spans[static_cast<std::size_t>(known - codes.begin())] = {
        static_cast<std::size_t>(*from - 1), static_cast<std::size_t>(size)};
    layout.record_bytes = std::max(layout.record_bytes, static_cast<std::size_t>(*to));
}

}  // namespace

Layout read_extensions(const Cell& record) {
    const std::string_view text = trim(record.text);
    const auto count = digits_at(text, 1, 2);
    if (!count || text.size() != 3 + 7 * static_cast<std::size_t>(*count))
        record.fail(fmt::format("the I record \"{}\" does not hold as many extensions as it says",
                                escape_for_message(text)),
                    "Take the recording as the flight recorder wrote it");
    Layout layout;
    for (std::size_t at = 3; at < text.size(); at += 7)
        add_extension(layout, record, at);
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

std::optional<std::int64_t> read_date(const Cell& record) {
    if (header_code(record.text) != "DTE") return std::nullopt;
    std::string_view text = header_text(record.text);
    if (text.starts_with("DATE")) text.remove_prefix(4);
    const auto day = digits_at(text, 0, 2);
    const auto month = digits_at(text, 2, 2);
    const auto year = digits_at(text, 4, 2);
    const bool ended = text.size() == 6 || (text.size() > 6 && !is_digit(text[6]));
    const auto found = day && month && year && ended
                           ? day_number(*year + (*year >= 80 ? 1900 : 2000), *month, *day)
                           : std::nullopt;
    if (!found)
        record.fail(fmt::format("\"{}\" is not a date", escape_for_message(record.text)),
                    "Dates are written HFDTE160701 or HFDTEDATE:160701,01: day, month, year");
    return found;
}

AltitudeReference read_altitude_reference(std::string_view record) {
    const std::string_view text = header_text(record);
    if (text.starts_with("ELL")) return AltitudeReference::ellipsoid;
    if (text.starts_with("GEO") || text.starts_with("MSL")) return AltitudeReference::geoid;
    if (text.starts_with("NIL")) return AltitudeReference::none;
    return AltitudeReference::not_stated;
}

}  // namespace runcert::igc
