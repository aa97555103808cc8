#pragma once

#include "schemas/observations/observations.h"
#include "stages/import/cell.h"

namespace runcert {

/// The fix type of RTKLIB's number Q, 0 to 7, which may be printed as "1.0000000".
/// Failure at the cell for any other text.
FixType read_rtklib_quality(const Cell& cell);

/// A count of satellites, 0 to 1000. Failure at the cell for anything else.
std::int16_t read_satellites(const Cell& cell);

}  // namespace runcert
