#pragma once

#include "core/gps_time.h"
#include "stages/import/igc/header.h"
#include "stages/import/row_collector.h"

namespace runcert::igc {

/// Whether a line has the shape of a B record: its fixed part, 35 characters.
bool is_fix(std::string_view line);

/// Nanoseconds of the UTC day that a B record states, TDS included; 86 400 s and more in a leap
/// second. /// Failure at its place.
std::int64_t read_time_of_day(const Cell& record, const Layout& layout);

/// The row of a B record, without its instant. Failure at its place.
TimedRow read_fix(const Cell& record, const Layout& layout, AltitudeReference reference);

}  // namespace runcert::igc
