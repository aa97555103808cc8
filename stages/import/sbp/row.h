#pragma once

#include <cstddef>
#include <string_view>

#include "stages/import/row_collector.h"

namespace runcert::sbp {

inline constexpr std::size_t record_bytes = 32;

/// What of the records a logger fills in; the older ones leave some fields at zero.
struct Filled {
    bool satellites = false;  ///< the count of satellites
    bool sdop = false;        ///< SDOP and VSDOP; without them the two bytes are flags
};

/// Looks through all the records. A logger without SDOP writes flags in its place, 0 or 1.
Filled find_filled(std::string_view records);

/// The row of a record, `record_bytes` long, that begins at `place`. Failure there.
TimedRow read_row(std::string_view record, const Filled& filled, const RecordingBytes& recording,
                  const RecordPlace& place);

}  // namespace runcert::sbp
