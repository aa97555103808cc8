#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/rinex/header.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/row_collector.h"

namespace runcert::rinex {
namespace {

constexpr const char* whole_file = "Take the navigation file of that day as it was issued";

/// The numbers of a record: three of its first line, then four a line ([RINEX3] table A6).
using Numbers = std::array<double, 31>;

double read_number(const Lines& lines, const SourceLine& line, std::size_t at) {
    std::string text(trim(characters(line.text, at, 19)));
    if (text.empty()) return 0.0;
    std::ranges::replace(text, 'D', 'e');
    std::ranges::replace(text, 'd', 'e');
    const auto value = parse_double(text);
    if (!value)
        lines.fail(line, at, fmt::format("\"{}\" is no number", escape_for_message(text)),
                   whole_file);
    return *value;
}

Ephemeris ephemeris_of(const Lines& lines, const SourceLine& first, Satellite satellite,
                       GpsTime clock_reference, const Numbers& n) {
    Ephemeris e;
    e.satellite = satellite;
    e.clock_reference = clock_reference;
    e.clock_offset_s = n[0];
    e.clock_drift = n[1];
    e.clock_drift_rate = n[2];
    e.crs = n[4];
    e.mean_motion_difference = n[5];
    e.mean_anomaly = n[6];
    e.cuc = n[7];
    e.eccentricity = n[8];
    e.cus = n[9];
    e.root_of_semi_major_axis = n[10];
    e.cic = n[12];
    e.right_ascension = n[13];
    e.cis = n[14];
    e.inclination = n[15];
    e.crc = n[16];
    e.argument_of_perigee = n[17];
    e.right_ascension_rate = n[18];
    e.inclination_rate = n[19];
    e.place = first.number;
    if (!(n[11] >= 0.0 && n[11] <= 604'800.0))
        lines.fail(first, 0, "the time of the ephemeris is outside of a week", whole_file);
    const auto whole = [&](double value, double most) {
        if (!(value >= 0.0 && value <= most))
            lines.fail(first, 0,
                       fmt::format("the ephemeris of {} has an impossible number of issue, "
                                   "health or source",
                                   to_text(satellite)),
                       whole_file);
        return static_cast<std::int32_t>(value);
    };
    e.reference = nearest_of_week(n[11], clock_reference);
    e.issue = whole(n[3], 1023.0);
    const std::int32_t health = whole(n[24], 511.0);
    if (satellite.system == SatelliteSystem::galileo) {
        // Data sources: bit 1 is F/NAV, whose clock is that of E1 and E5a. Health: three bits a
        // signal, E1-B first ([RINEX3] table A8).
        const std::int32_t sources = whole(n[20], 1023.0);
        e.is_fnav = (sources & 0b10) != 0;
        e.group_delay_s = e.is_fnav ? n[25] : n[26];
        e.healthy = (health & 0b111) == 0 && (!e.is_fnav || (health & 0b111'000) == 0);
    } else {
        e.group_delay_s = n[25];
        e.healthy = health == 0;
    }
    if (!is_plausible(e))
        lines.fail(first, 0,
                   fmt::format("the ephemeris of {} is no orbit of a navigation satellite",
                               to_text(satellite)),
                   whole_file);
    return e;
}

class NavigationReader {
  public:
    explicit NavigationReader(const RecordingBytes& recording) : lines_(recording) {}

    NavigationFile read() {
        if (!read_header()) return std::move(file_);
        while (const auto line = lines_.next()) {
            if (trim(line->text).empty()) continue;
            read_record(*line);
        }
        (void)std::move(log_).finish(file_.notes);
        for (const auto& [system, count] : set_aside_)
            file_.notes.push_back(
                fmt::format("Ephemerides of {} are not used: {}.", name_of(system), count));
        return std::move(file_);
    }

  private:
    /// False for a file of version 2 whose system is not used, of which nothing is read.
    bool read_header() {
        const FirstLine first = read_first_line(lines_);
        modern_ = first.version >= 300;
        const bool glonass = first.kind == 'G', sbas = first.kind == 'H';
        const bool other = !modern_ && (glonass || sbas);
        if ((first.kind != 'N' && !other) || first.version < 200 || first.version >= 400)
            throw Failure(lines_.recording().name + ":1",
                          fmt::format("RINEX {}.{:02} of kind \"{}\" is not read as navigation",
                                      first.version / 100, first.version % 100,
                                      escape_for_message({&first.kind, 1})),
                          "Give navigation of GPS (version 2), or of several systems (version 3, "
                          "kind N)");
        if (other) {
            file_.notes.push_back(
                fmt::format("Navigation of {} is not used.", glonass ? "GLONASS" : "SBAS"));
            return false;
        }
        while (const auto line = lines_.next())
            if (label_of(line->text) == "END OF HEADER") return true;
        throw Failure(lines_.recording().name + ":1", "the header has no end (END OF HEADER)",
                      "Take the whole file");
    }

    /// Lines of a record begin with blanks, but its first one.
    bool is_continued(const SourceLine& line) const {
        return line.text.starts_with(modern_ ? "    " : "   ");
    }

    void read_record(const SourceLine& first) {
        std::vector<SourceLine> lines{first};
        while (const auto line = lines_.next()) {
            if (!is_continued(*line) || lines.size() >= 8) {
                lines_.put_back();
                break;
            }
            lines.push_back(*line);
        }
        try {
            const Satellite satellite =
                modern_ ? read_satellite(lines_, first, 0)
                        : Satellite{SatelliteSystem::gps,
                                    static_cast<std::uint8_t>(
                                        read_count(lines_, first, 0, 2, 1, 99, "satellite"))};
            const bool used = satellite.system == SatelliteSystem::gps ||
                              satellite.system == SatelliteSystem::galileo;
            if (used)
                file_.ephemerides.push_back(read_ephemeris(lines, satellite));
            else
                ++set_aside_[satellite.system];
            log_.count_good();
        } catch (const Failure& failure) {
            log_.count_bad(first, failure, std::ssize(file_.ephemerides));
        }
    }

    Ephemeris read_ephemeris(const std::vector<SourceLine>& lines, Satellite satellite) const {
        const SourceLine& first = lines.front();
        if (lines.size() < 8)
            lines_.fail(first, 0,
                        fmt::format("the ephemeris of {} has {} lines of 8", to_text(satellite),
                                    lines.size()),
                        whole_file);
        const TimeFields at = modern_ ? TimeFields{4, 4, 9, 12, 15, 18, 21, 2}
                                      : TimeFields{3, 2, 6, 9, 12, 15, 17, 5};
        const GpsTime clock_reference = read_time(lines_, first, at);
        Numbers numbers{};
        const std::size_t first_at = modern_ ? 23 : 22;
        for (std::size_t i = 0; i < 3; ++i)
            numbers[i] = read_number(lines_, first, first_at + 19 * i);
        for (std::size_t i = 3; i < numbers.size(); ++i)
            numbers[i] =
                read_number(lines_, lines[1 + (i - 3) / 4], (modern_ ? 4 : 3) + 19 * ((i - 3) % 4));
        return ephemeris_of(lines_, first, satellite, clock_reference, numbers);
    }

    Lines lines_;
    NavigationFile file_;
    RecordLog log_;
    std::map<SatelliteSystem, std::int64_t> set_aside_;
    bool modern_ = false;
};

}  // namespace

NavigationFile read_navigation(const RecordingBytes& recording) {
    return NavigationReader(recording).read();
}

}  // namespace runcert::rinex
