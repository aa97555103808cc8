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
    std::optional<std::int64_t> first_time_ns;  ///< of the first row with a time; since midnight
    LongitudeSense longitudes = LongitudeSense::assumed_west;
    std::optional<double> first_longitude_deg;  ///< east positive
};

/// Looks at the rows from here on, as few as needed.
///
/// Racelogic counts longitudes positive to the west; other writers of the format do not, and no
/// file says so. But the rows hold a heading, clockwise from north, beside the longitude: a craft
/// that heads east moves to greater longitudes where they count to the east, to smaller ones
/// otherwise. Over the first 100 m of way to the east or west, three quarters of it must agree.
Survey survey(LineReader lines, const RecordingBytes& recording, const Layout& layout);

/// A note on how the longitudes were taken, with the first position for a person to check.
std::string longitude_note(LongitudeSense sense, double latitude_deg, double longitude_deg);

}  // namespace runcert::vbo
