#include "stages/import/rinex/rinex.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/format.h"
#include "stages/import/rinex/header.h"

namespace runcert::rinex {
std::optional<SourceLine> Lines::next() {
    if (std::exchange(again_, false)) return last_;
    auto line = reader_.next();
    if (line) last_ = line;
    return line;
}

void Lines::fail(const SourceLine& line, std::size_t at, const std::string& what,
                 const std::string& remedy) const {
    throw Failure(place_in(recording_, line.number, at + 1), what, remedy);
}

std::string_view characters(std::string_view line, std::size_t at, std::size_t size) {
    return at >= line.size() ? std::string_view() : line.substr(at, size);
}

std::string_view label_of(std::string_view line) {
    return trim(characters(line, 60, 20));
}

FirstLine read_first_line(Lines& lines) {
    require_readable(lines.recording());
    const auto line = lines.next();
    const auto version =
        line ? parse_double(trim(characters(line->text, 0, 9))) : std::optional<double>();
    if (!line || label_of(line->text) != "RINEX VERSION / TYPE" || !version || *version < 1.0 ||
        *version > 9.99)
        throw Failure(place_in(lines.recording(), 1, 1), "this is no RINEX file",
                      "Give observations or navigation in RINEX 2.10 to 3.05");
    const std::string_view kind = characters(line->text, 20, 1);
    const std::string_view system = characters(line->text, 40, 1);
    return {.version = static_cast<int>(std::lround(*version * 100.0)),
            .kind = kind.empty() ? ' ' : kind[0],
            .system = system.empty() ? ' ' : system[0]};
}

int read_count(const Lines& lines, const SourceLine& line, std::size_t at, std::size_t size,
               int least, int most, std::string_view meaning) {
    const std::string_view text = trim(characters(line.text, at, size));
    const auto value = parse_integer(text);
    if (!value || *value < least || *value > most)
        lines.fail(line, at,
                   fmt::format("\"{}\" is no {} ({} to {})", escape_for_message(text), meaning,
                               least, most),
                   "Take the file as the receiver or its converter wrote it");
    return static_cast<int>(*value);
}

GpsTime read_time(const Lines& lines, const SourceLine& line, const TimeFields& at) {
    int year = read_count(lines, line, at.year, at.year_digits, 0, 2200, "year");
    if (at.year_digits <= 2) year += year >= 80 ? 1900 : 2000;
    CalendarTime time{.year = year,
                      .month = read_count(lines, line, at.month, 2, 1, 12, "month"),
                      .day = read_count(lines, line, at.day, 2, 1, 31, "day"),
                      .hour = read_count(lines, line, at.hour, 2, 0, 23, "hour"),
                      .minute = read_count(lines, line, at.minute, 2, 0, 59, "minute")};
    const std::string_view text = trim(characters(line.text, at.second, at.second_digits));
    const auto second = parse_double(text);
    // 60 is how some programs round 59.99999999.
    if (!second || *second < 0.0 || *second > 60.0 || year < 1980)
        lines.fail(line, second ? at.year : at.second,
                   fmt::format("\"{}\" is no time", escape_for_message(second ? line.text : text)),
                   "Take the file as the receiver or its converter wrote it");
    try {
        return GpsTime::from_calendar(time).plus_nanoseconds(
            static_cast<std::int64_t>(std::llround(*second * 1e9)));
    } catch (const Failure& failure) {
        lines.fail(line, at.year, failure.problem(), failure.remedy());
    }
}

Satellite read_satellite(const Lines& lines, const SourceLine& line, std::size_t at) {
    std::string name(characters(line.text, at, 3));
    name.resize(3, ' ');
    if (name[0] == ' ') name[0] = 'G';
    if (name[1] == ' ') name[1] = '0';
    Satellite satellite;
    if (!from_text(name, satellite))
        lines.fail(line, at, fmt::format("\"{}\" is no satellite", escape_for_message(name)),
                   "Take the file as the receiver or its converter wrote it");
    return satellite;
}

bool recognises(std::string_view bytes) {
    return bytes.substr(0, 81).find("RINEX VERSION") != std::string_view::npos;
}

bool is_chosen(const Receiver& receiver, const RecordingBytes& recording) {
    const bool any = receiver.format.empty() || receiver.format == "auto";
    return receiver.format == "rinex" || (any && recognises(recording.bytes));
}

extern const Format format{
    .name = "rinex",
    .what = "RINEX with base and navigation files",
    .place = 110,
    .of_satellites = true,
    .time_origin = "GPS time of the receiver's measurements, as RTKLIB solved it",
};

}  // namespace runcert::rinex
