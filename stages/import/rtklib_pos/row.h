#pragma once

#include <optional>
#include <span>

#include "stages/import/row_collector.h"
#include "stages/import/rtklib_pos/header.h"

namespace runcert::rtklib_pos {

/// Reads the fields of a row, as many as the layout says. `base` is needed, and given, where the
/// coordinates are a baseline.
TimedRow read_row(std::span<const Cell> fields, const Layout& layout,
                  const std::optional<LocalFrame>& base);

}  // namespace runcert::rtklib_pos
