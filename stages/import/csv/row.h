#pragma once

#include <span>

#include "schemas/attempt/attempt.h"
#include "stages/import/csv/layout.h"
#include "stages/import/row_collector.h"

namespace runcert::csv {

/// Reads the fields of a row, as many as the layout says. A row with an empty coordinate has no
/// position.
TimedRow read_row(std::span<const Cell> fields, const Layout& layout,
                  const Description& description, const Receiver& receiver);

}  // namespace runcert::csv
