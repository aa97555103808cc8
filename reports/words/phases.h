#pragma once

#include <string>
#include <vector>

#include "schemas/screened_phase/screened_phase.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// What screening found of a receiver's carrier phases, a sentence each: slips, pairs of epochs
/// that could not be judged, jumps of the clock, the motion beside that of the positions.
std::vector<std::string> phase_sentences(const ScreenedPhaseTable& phases);

/// What they say of a certified window: satellites, slips, their speed beside that of the
/// positions, and by how much the displacements differ.
std::string phase_window_sentence(const WitnessedSpeed& phases);

/// The evidence of a slip, in the row that has it: "0.98 ± 0.04 cycles; square sum of the weighted
/// residuals 571.8, at most 22.5; Doppler 0.99 cycles".
std::string slip_evidence(const ScreenedPhase& row);

}  // namespace runcert
