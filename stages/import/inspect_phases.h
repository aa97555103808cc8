#pragma once

#include <string>

#include "stages/import/phase_table.h"

namespace runcert {

/// What raw measurements hold, in a few lines: satellites, signals, gaps, slips, whether the
/// receiver moved, and its fastest 3 s by carrier phase alone.
std::string phase_inspection_text(const StreamedPhases& phases, const std::string& path);

}  // namespace runcert
