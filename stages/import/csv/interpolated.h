#pragma once

#include <cstddef>
#include <vector>

#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert::csv {

/// A row of a table, and where it stands.
struct PlacedRow {
    TimedRow row;
    RecordPlace place;
};

/// Takes out the rows that a program put between fixes, on the straight line between them in
/// latitude, longitude, height and speed, to the last decimal that is written: they were not
/// measured. A row that lies so by chance and whole intervals of the fixes from the one before
/// stays. The rows' order is that of the recording.
///
/// Returns how many were taken out.
std::size_t take_out_interpolated(std::vector<PlacedRow>& rows);

}  // namespace runcert::csv
