#pragma once

#include <span>
#include <string>

#include "simulation/simulate.h"

namespace runcert {

/// The recorded epochs as RTKLIB writes a solution (.pos; RTKLIB 2.4.3 manual, appendix B.1):
/// calendar GPS time, latitude, longitude, height. Failure (at "simulation") where the spec has
/// no place or no start time.
std::string rtklib_pos_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs);

/// The recorded epochs as CSV: epoch, time_s, east_m, north_m, up_m where heights are recorded,
/// and fix (fixed or float) where the spec has float stretches.
std::string plane_csv_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs);

/// The true run at every epoch, those inside gaps too, as CSV: time_s, east_m, north_m, up_m,
/// speed_m_s, acceleration_m_s2, to 6 decimals.
std::string truth_csv_text(std::span<const SimulatedEpoch> epochs);

}  // namespace runcert
