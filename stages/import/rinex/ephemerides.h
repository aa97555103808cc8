#pragma once

#include <string>
#include <vector>

#include "satellites/ephemeris.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

/// What a navigation file holds.
struct NavigationFile {
    std::vector<Ephemeris> ephemerides;  ///< of GPS and Galileo, `place` its first line
    std::vector<std::string> notes;      ///< what was set aside
};

/// Reads broadcast navigation in RINEX 2.00 to 2.12 (GPS) and 3.00 to 3.05 (GPS, Galileo; others
/// are set aside). A record that cannot be read is set aside with a note. Failure with the line
/// where the file is none, or of another version, and where most records cannot be read.
NavigationFile read_navigation(const RecordingBytes& recording);

}  // namespace runcert::rinex
