#include "stages/import/rinex/rinex.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/format.h"
#include "stages/import/rinex/header.h"

namespace runcert::rinex {
namespace {

constexpr int most_types = 200;

}  // namespace
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
                   as_written);
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
                   as_written);
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
                   as_written);
    return satellite;
}

void ObservationHeader::read() {
    const FirstLine first = read_first_line(lines_);
    version = first.version;
    const bool known = (version >= 210 && version < 300) || (version >= 300 && version < 500);
    if (first.kind != 'O' || !known)
        throw Failure(
            lines_.recording().name + ":1",
            fmt::format("RINEX {}.{:02} of kind \"{}\" is not read as observations", version / 100,
                        version % 100, escape_for_message({&first.kind, 1})),
            "Give observations (kind O) in RINEX 2.10 to 4.02");
    format = fmt::format("RINEX {}.{:02}", version / 100, version % 100);
    // Version 2 of one system may leave out its letter, and its time system.
    if (first.system == 'R') scale = Scale::utc;
    if (first.system == 'C' && version >= 300) scale = Scale::beidou;
    bool ended = false;
    while (const auto line = lines_.next()) {
        if (label_of(line->text) == "END OF HEADER") {
            ended = true;
            break;
        }
        read_line(*line);
    }
    if (!ended)
        throw Failure(lines_.recording().name + ":1", "the header has no end (END OF HEADER)",
                      "Take the whole file");
    require_types();
}

Instrument instrument_of(std::string_view bytes) {
    Instrument found;
    LineReader lines(bytes);
    while (const auto line = lines.next()) {
        const auto part = [&](std::size_t at) {
            return instrument_part(characters(line->text, at, 20));
        };
        const std::string_view label = label_of(line->text);
        if (label == "END OF HEADER") break;
        if (label == "REC # / TYPE / VERS") {
            found.serial = part(0);
            found.model = part(20);
            found.firmware = part(40);
        }
        if (label != "ANT # / TYPE") continue;
        found.antenna = part(20);
        if (const std::string number = part(0); !number.empty())
            found.antenna += (found.antenna.empty() ? "number " : ", number ") + number;
    }
    return found;
}

void ObservationHeader::require_types() const {
    const auto has_phase = [](const Types& all) {
        return std::ranges::any_of(all, [](const auto& type) { return type.what == 'L'; });
    };
    for (const Types& each : types)
        if (has_phase(each)) return;
    throw Failure(lines_.recording().name + ":1",
                  "the header names no carrier phase of a system that is used (GPS, Galileo)",
                  "Record and convert with carrier phases (types L1, L1C)");
}

void ObservationHeader::read_line(const SourceLine& line) {
    const std::string_view label = label_of(line.text);
    if (label == "# / TYPES OF OBSERV" && version < 300) return read_types_2(line);
    if (label == "SYS / # / OBS TYPES" && version >= 300) return read_types_3(line);
    // Said of receivers that square the signal. Their phases are whole cycles but for slips, which
    // are looked for by halves, too; an open half cycle has its indicator.
    if (label == "WAVELENGTH FACT L1/2" &&
        characters(line.text, 0, 12).find('2') != std::string_view::npos)
        notes.push_back(fmt::format(
            "Line {}: the receiver's phases may slip by half a cycle (wavelength factor 2).",
            line.number));
    if (label == "TIME OF FIRST OBS") return read_time_system(line);
    if (label == "SYS / SCALE FACTOR") return read_scale_factor(line);
    if (label == "APPROX POSITION XYZ") return read_position(line);
    if (label == "REC # / TYPE / VERS") device = std::string(trim(characters(line.text, 20, 20)));
}

void ObservationHeader::read_types_2(const SourceLine& line) {
    const std::string_view count = trim(characters(line.text, 0, 6));
    if (!count.empty()) {
        type_count_ = read_count(lines_, line, 0, 6, 1, most_types, "number of types");
        type_names_.clear();
    }
    for (std::size_t i = 0; i < 9 && std::ssize(type_names_) < type_count_; ++i)
        type_names_.emplace_back(trim(characters(line.text, 6 + 6 * i, 6)));
    if (std::ssize(type_names_) == type_count_) set_types_2();
}

/// The signals of version 2's types, which name no attribute.
void ObservationHeader::set_types_2() {
    const auto has = [&](std::string_view type) {
        return std::ranges::find(type_names_, type) != type_names_.end();
    };
    for (const SatelliteSystem system : {SatelliteSystem::gps, SatelliteSystem::galileo}) {
        Types named;
        for (const std::string& name : type_names_) {
            ObservationType type;
            if (name.size() == 2 && name[1] >= '1' && name[1] <= '9') {
                const char band = name[1];
                type.what = name[0] == 'P' ? 'C' : name[0];
                char attribute = 'X';
                if (system == SatelliteSystem::gps && band == '1')
                    attribute = name[0] == 'P' || !has("C1") ? 'W' : 'C';
                if (system == SatelliteSystem::gps && band == '2')
                    attribute = name[0] == 'P' || (name[0] != 'C' && has("P2")) ? 'W' : 'X';
                type.signal = {static_cast<std::uint8_t>(band - '0'), attribute};
            }
            named.push_back(type);
        }
        types[static_cast<std::size_t>(system)] = std::move(named);
    }
}

void ObservationHeader::read_types_3(const SourceLine& line) {
    const std::string_view letter = characters(line.text, 0, 1);
    if (letter.empty() || letter[0] != ' ') {
        const auto system = letter.empty() ? std::nullopt : system_of_letter(letter[0]);
        if (!system)
            lines_.fail(line, 0,
                        fmt::format("\"{}\" is no satellite system", escape_for_message(letter)),
                        as_written);
        system_ = *system;
        type_count_ = read_count(lines_, line, 3, 3, 1, most_types, "number of types");
        types[static_cast<std::size_t>(system_)].clear();
    }
    Types& mine = types[static_cast<std::size_t>(system_)];
    for (std::size_t i = 0; i < 13 && std::ssize(mine) < type_count_; ++i) {
        const std::string_view name = characters(line.text, 7 + 4 * i, 3);
        ObservationType type;
        if (name.size() == 3 && from_text(name.substr(1), type.signal)) type.what = name[0];
        mine.push_back(type);
    }
}

void ObservationHeader::read_time_system(const SourceLine& line) {
    const std::string_view name = trim(characters(line.text, 48, 3));
    if (name == "GPS" || name == "GAL" || name == "QZS" || name == "IRN")
        scale = Scale::gps;
    else if (name == "GLO" || name == "UTC")
        scale = Scale::utc;
    else if (name == "BDT")
        scale = Scale::beidou;
    else if (!name.empty())
        lines_.fail(line, 48,
                    fmt::format("the time system \"{}\" is not known", escape_for_message(name)),
                    "Convert with GPS time (GPS)");
}

void ObservationHeader::read_scale_factor(const SourceLine& line) {
    const int factor = read_count(lines_, line, 2, 4, 1, 10'000, "scale factor");
    if (factor != 1)
        lines_.fail(line, 2, fmt::format("observations scaled by {} are not read", factor),
                    "Convert without scale factors");
}

void ObservationHeader::read_position(const SourceLine& line) {
    Eigen::Vector3d position;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value = parse_double(trim(characters(line.text, 14 * i, 14)));
        if (!value || std::abs(*value) > 1e8) return;
        position[static_cast<Eigen::Index>(i)] = *value;
    }
    if (position.norm() > 6.0e6) approximate_position = Ecef{position};
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
    .stamps_satellite_time = true,
    .time_origin = "GPS time of the receiver's measurements, as RTKLIB solved it",
};

}  // namespace runcert::rinex
