#pragma once

#include <string>
#include <string_view>

#include "schemas/trajectory/trajectory.h"

// What the estimation found of noise and frame, as report and audit say it.

namespace runcert {

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
