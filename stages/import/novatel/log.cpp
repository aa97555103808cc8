#include "stages/import/novatel/log.h"

#include <fmt/format.h>

#include <array>
#include <charconv>

#include "core/text.h"

namespace runcert::novatel {
namespace {

constexpr std::array<std::uint32_t, 256> make_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t value = i;
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1U) != 0 ? (value >> 1) ^ 0xEDB88320U : value >> 1;
        table[i] = value;
    }
    return table;
}

constexpr std::array<std::uint32_t, 256> table = make_table();

/// Places in the header, counted in fields.
constexpr std::size_t long_time_status = 4, long_week = 5, long_fields = 10;
constexpr std::size_t short_week = 1, short_fields = 3;
/// Unicore's header has as many fields, no port, and milliseconds: "BESTPOSA,97,GPS,FINE,2409,...".
constexpr std::size_t unicore_scale = 2, unicore_time_status = 3, unicore_week = 4;

/// Splits at commas, but for those in quotation marks.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording, std::size_t from,
                        std::size_t to) {
    std::vector<Cell> cells;
    bool quoted = false;
    std::size_t begin = from;
    for (std::size_t at = from; at <= to; ++at) {
        if (at < to && line.text[at] == '"') quoted = !quoted;
        if (at < to && (line.text[at] != ',' || quoted)) continue;
        cells.push_back({line.text.substr(begin, at - begin), &recording, line.number, begin + 1});
        begin = at + 1;
    }
    return cells;
}

void require_checksum(const SourceLine& line, const RecordingBytes& recording, std::size_t star) {
    const Cell written{trim(line.text.substr(star + 1)), &recording, line.number, star + 2};
    std::uint32_t value = 0;
    const char* end = written.text.data() + written.text.size();
    const auto result = std::from_chars(written.text.data(), end, value, 16);
    const std::uint32_t computed = crc32(line.text.substr(1, star - 1));
    if (written.text.size() != 8 || result.ec != std::errc() || result.ptr != end ||
        value != computed)
        written.fail(fmt::format("the checksum is {:08x}, and the line says \"{}\"", computed,
                                 escape_for_message(written.text)),
                     "The line is unreadable; hand in the recording as the receiver wrote it");
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char c : bytes)
        value = table[(value ^ static_cast<unsigned char>(c)) & 0xFFU] ^ (value >> 8);
    return value;
}

std::string_view log_name(std::string_view line) {
    if (!line.starts_with('#') && !line.starts_with('%')) return {};
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos || line.find(';') == std::string_view::npos) return {};
    const std::string_view name = line.substr(1, comma - 1);
    return name.ends_with('A') ? name : std::string_view();
}

bool is_log(std::string_view line, std::string_view name) {
    return log_name(line) == name;
}

Log read_log(const SourceLine& line, const RecordingBytes& recording) {
    const Cell start{line.text, &recording, line.number, 1};
    const std::size_t star = line.text.rfind('*');
    const std::size_t semicolon = line.text.find(';');
    if (star == std::string_view::npos || star < semicolon)
        start.fail("the log is cut off before its checksum",
                   "Hand in the whole recording, as the receiver wrote it");
    require_checksum(line, recording, star);
    const std::vector<Cell> header = split(line, recording, 1, semicolon);
    const bool is_short = line.text.starts_with('%');
    if (header.size() != (is_short ? short_fields : long_fields))
        start.fail(fmt::format("the log's header has {} fields, not {}", header.size(),
                               is_short ? short_fields : long_fields),
                   "Take the recording as the receiver wrote it");
    const bool unicore =
        !is_short && (header[unicore_scale].text == "GPS" || header[unicore_scale].text == "BDS");
    if (unicore && header[unicore_scale].text != "GPS")
        header[unicore_scale].fail("the log counts BeiDou's time, which is read of no recording",
                                   "Let the receiver count GPS time, and record again");
    const std::size_t week = is_short ? short_week : unicore ? unicore_week : long_week;
    return {.name = header[0].text,
            .time_status = is_short ? std::string_view()
                                    : header[unicore ? unicore_time_status : long_time_status].text,
            .week = header[week],
            .seconds = header[week + 1],
            .in_milliseconds = unicore,
            .fields = split(line, recording, semicolon + 1, star)};
}

}  // namespace runcert::novatel
