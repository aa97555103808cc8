#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "run/stage_run.h"
#include "store/measured_series.h"

namespace runcert {

/// The series that the attempt hands in under a key ("wind"), read from the run's copy; nothing
/// where it hands in none. It is spoken of by the attempt's name for it: what a stage writes must
/// not hold the folder that it is made in.
std::optional<MeasuredSeries> handed_in_series(StageRun& run, std::string_view key,
                                               const std::optional<GpsTime>& first_epoch);

/// All of them, by key, of a stage that reads a part of the attempt: those that it hears.
std::map<std::string, MeasuredSeries> all_handed_in_series(
    StageRun& run, const std::optional<GpsTime>& first_epoch);

}  // namespace runcert
