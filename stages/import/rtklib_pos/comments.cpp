#include <fmt/format.h>

#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/earth.h"
#include "stages/import/rtklib_pos/header.h"

// What the header lines before the column names say about base and datum (RTKLIB 2.4.3,
// outheader() of postpos.c and outsolheads() of solution.c).

namespace runcert::rtklib_pos {
namespace {

constexpr std::string_view reference_key = "% ref pos";

/// Numbers above this are metres from the Earth's centre, not degrees.
constexpr double largest_degrees = 360.0;

Geodetic read_base(const std::vector<Cell>& cells) {
    if (cells.size() == 7) {
        const Geodetic base{.latitude = read_dms(cells[0], cells[1], cells[2], "base latitude"),
                            .longitude = read_dms(cells[3], cells[4], cells[5], "base longitude"),
                            .height_m = read_real(cells[6], "base height")};
        return checked_geodetic(base, cells[0], cells[3], cells[6]);
    }
    const Eigen::Vector3d values(read_real(cells[0], "base position"),
                                 read_real(cells[1], "base position"),
                                 read_real(cells[2], "base position"));
    if (values.head<2>().cwiseAbs().maxCoeff() > largest_degrees)
        return checked_ecef(values, cells[0]);
    const Geodetic base{.latitude = Angle::from_degrees(values(0)),
                        .longitude = Angle::from_degrees(values(1)),
                        .height_m = values(2)};
    return checked_geodetic(base, cells[0], cells[1], cells[2]);
}

}  // namespace

std::optional<Geodetic> read_reference_position(const SourceLine& line,
                                                const RecordingBytes& recording) {
    if (!line.text.starts_with(reference_key)) return std::nullopt;
    const std::size_t colon = line.text.find(':');
    const Cell start{line.text, &recording, line.number, 1};
    std::vector<Cell> cells;
    if (colon != std::string_view::npos) {
        const std::string_view values = line.text.substr(colon + 1);
        const std::size_t found = values.find_first_of(",;\t");
        cells = split_words(line, values, recording,
                            found == std::string_view::npos ? '\0' : values[found]);
    }
    if (cells.size() != 3 && cells.size() != 7)
        start.fail("the base position is not three numbers, nor seven in degrees-minutes-seconds",
                   "Take the solution as RTKLIB wrote it");
    return read_base(cells);
}

void read_processing(std::string_view line, std::optional<Processing>& processing) {
    constexpr std::size_t most = 40, longest = 120, widest_key = 16;
    const std::size_t colon = line.find(':');
    if (!line.starts_with('%') || colon == std::string_view::npos || colon > widest_key ||
        line.find('(') < colon)
        return;
    const std::string_view key = trim(line.substr(1, colon - 1));
    const std::string value = escape_for_message(trim(line.substr(colon + 1)), longest);
    if (key.empty() || value.empty()) return;
    if (!processing) processing.emplace();
    if (key == "program") {
        processing->program = value;
    } else if (key == "inp file") {
        if (processing->files.size() < most)
            processing->files.push_back(value.substr(value.find_last_of("/\\") + 1));
    } else if (key == "obs start") {
        processing->begin = value;
    } else if (key == "obs end") {
        processing->end = value;
    } else if (processing->options.size() < most) {
        processing->options.push_back(fmt::format("{}: {}", escape_for_message(key), value));
    }
}

Angle read_dms(const Cell& degrees, const Cell& minutes, const Cell& seconds,
               std::string_view meaning) {
    const double whole = read_real(degrees, meaning);
    const double minute = read_real(minutes, meaning);
    const double second = read_real(seconds, meaning);
    if (whole != std::floor(whole))
        degrees.fail(fmt::format("the {} has a fraction of degrees before its minutes", meaning),
                     "Take the solution as RTKLIB wrote it");
    if (minute != std::floor(minute) || minute < 0.0 || minute >= 60.0)
        minutes.fail(
            fmt::format("the minutes of the {} are not a whole number from 0 to 59", meaning),
            "Take the solution as RTKLIB wrote it");
    // RTKLIB rounds seconds for print, and may so write 60.
    if (second < 0.0 || second > 60.0)
        seconds.fail(fmt::format("the seconds of the {} are not from 0 to 60", meaning),
                     "Take the solution as RTKLIB wrote it");
    return Angle::from_dms(std::signbit(whole) ? -1 : 1, std::abs(whole), minute, second);
}

void require_datum(const SourceLine& line, const RecordingBytes& recording) {
    const Cell start{line.text, &recording, line.number, 1};
    if (line.text.find("=Tokyo") != std::string_view::npos)
        start.fail("the positions are in the Tokyo datum", "Export the solution again in WGS 84");
    if (line.text.find("height=WGS84/geodetic") != std::string_view::npos)
        start.fail("the heights are above a geoid (\"geodetic\"), not above the ellipsoid",
                   "Export the solution again with ellipsoidal heights");
}

}  // namespace runcert::rtklib_pos
