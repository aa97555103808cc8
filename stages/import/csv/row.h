#pragma once

#include <span>

#include "schemas/attempt/attempt.h"
#include "stages/import/csv/layout.h"
#include "stages/import/row_collector.h"

namespace runcert::csv {

/// Whether the row holds a new fix; false where the column for that says 0. Failure at any other
/// text.
bool is_new_fix(std::span<const Cell> fields, const Layout& layout);

/// Reads the fields of a row, as many as the layout says. A row with an empty coordinate has no
/// position.
TimedRow read_row(std::span<const Cell> fields, const Layout& layout,
                  const Description& description, const Receiver& receiver);

}  // namespace runcert::csv
