#pragma once

#include <string>
#include <vector>

#include "schemas/screened_phase/declared.h"
#include "schemas/windows/windows.h"

// What a receiver's carrier phases show.

namespace runcert {

/// What screening found of a receiver's carrier phases, a sentence each: slips, pairs of epochs
/// that could not be judged, jumps of the clock, the motion beside that of the positions.
std::vector<std::string> phase_sentences(const ScreenedPhaseTable& phases);

/// What they say of a certified window: satellites, slips, their speed beside that of the
/// positions, and by how much the displacements differ.
std::string phase_window_sentence(const WitnessedSpeed& phases);

}  // namespace runcert
