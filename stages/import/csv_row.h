#pragma once

#include <span>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/csv_layout.h"

namespace runcert::csv {

/// A row in the terms of an observation.
struct Row {
    Observation observation;  ///< without time, number and source
    GpsTime instant;          ///< on relative time, from time zero as if that were the GPS epoch
};

/// Reads the fields of a row, as many as the layout says. A row with an empty coordinate has no
/// position.
Row read_row(std::span<const Cell> fields, const Layout& layout, const Description& description,
             const Receiver& receiver);

}  // namespace runcert::csv
