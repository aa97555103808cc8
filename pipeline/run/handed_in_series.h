#pragma once

#include <optional>
#include <string_view>

#include "files/measured_series.h"
#include "run/stage_run.h"

namespace runcert {

/// The series that the attempt hands in under a key ("wind", "current", "wheel", "gates"), read
/// from the run's copy; nothing where it hands in none. It is spoken of by the attempt's name for
/// it: what a stage writes must not hold the folder that it is made in.
std::optional<MeasuredSeries> handed_in_series(StageRun& run, std::string_view key,
                                               const std::optional<GpsTime>& first_epoch);

}  // namespace runcert
