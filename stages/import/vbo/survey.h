#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "stages/import/vbo/header.h"

namespace runcert::vbo {

/// Which way longitudes count, and how that is known.
enum class LongitudeSense {
    west_positive,  ///< Racelogic's rule, and the headings agree
    east_positive,  ///< the headings show it
    assumed_west    ///< Racelogic's rule; the headings show nothing
};

/// What has to be known before the rows are read.
struct Survey {
    Coordinates coordinates = Coordinates::minutes;
    bool coordinates_by_speeds = false;  ///< the recorded speeds show what they are written in
    /// Whether the recorded speeds are those of the positions; nothing where there is too little.
    std::optional<bool> speeds_fit;
    double misfit = 0.0;  ///< of the two ways, where speeds_fit is there: logarithm of their ratio
    std::optional<std::int64_t> first_time_ns;  ///< of the first row with a time; since midnight
    LongitudeSense longitudes = LongitudeSense::assumed_west;
    std::optional<double> first_longitude_deg;  ///< east positive
};

/// Looks at the rows from here on, as few as needed.
///
/// Some writers have decimal degrees, or degrees and minutes (DDMM.MMMM), where Racelogic has
/// minutes of arc. Over the first 3 km the way between the positions is that of the recorded
/// speeds, within a quarter, in one of them alone: minutes and packed degrees differ by the
/// meridians' convergence. Without speeds, coordinates are what fits on the Earth, and degrees
/// where minutes would put them within 2 degrees of latitude 0 and 3 of longitude 0.
///
/// Racelogic counts longitudes positive to the west; other writers of the format do not, and no
/// file says so. But the rows hold a heading, clockwise from north, beside the longitude: a craft
/// that heads east moves to greater longitudes where they count to the east, to smaller ones
/// otherwise. Over the first 100 m of way to the east or west, three quarters of it must agree.
Survey survey(const LineReader& lines, const RecordingBytes& recording, const Layout& layout);

/// A note on what coordinates are written in, and how that is known; empty for the format's rule.
std::string coordinates_note(const Survey& survey, const Layout& layout);

/// A note on how the longitudes were taken, with the first position for a person to check.
std::string longitude_note(LongitudeSense sense, double latitude_deg, double longitude_deg);

}  // namespace runcert::vbo
