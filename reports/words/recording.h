#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schemas/observations/observations.h"
#include "schemas/screened_phase/declared.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"

// What a recording says of itself, and what its phases and the estimate show.

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

/// "estimated from 601 epochs", or why it was not, and how many that would have taken.
std::string noise_status_text(const NoiseSummary& noise);

/// A parameter of the noise with its standard uncertainty: as a sum where that is small, else as a
/// factor, since it is the logarithm that is nearly normal: "0.0121 m ± 0.0009 m", "0.42 m, × or ÷
/// 1.7". Says where the search ended at a limit of its range.
std::string noise_parameter_text(const NoiseParameter& parameter, const NoiseSummary& noise,
                                 std::string_view unit = {});

/// Of coordinates that are not tied to the Earth.
std::string engineering_crs_text();

/// From when on a place has an origin of its own, and where that is.
std::string place_text(const FramePlace& place);

}  // namespace runcert
