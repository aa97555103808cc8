#pragma once

#include <optional>
#include <span>

#include "schemas/observations/observations.h"
#include "stages/import/rtklib_pos_header.h"

namespace runcert::rtklib_pos {

/// A row in the terms of an observation.
struct Row {
    Observation observation;  ///< without time, number and source
    GpsTime instant;
};

/// Reads the fields of a row, as many as the layout says. `base` is needed, and given, where the
/// coordinates are a baseline.
Row read_row(std::span<const Cell> fields, const Layout& layout,
             const std::optional<LocalFrame>& base);

}  // namespace runcert::rtklib_pos
