#pragma once

#include <vector>

#include "schemas/screened/screened.h"

namespace runcert {

/// Looks for positions that no receiver measured, among the rows with a position, in the order of
/// the recording, while the craft moves at 1 m/s or more (over five rows before and after):
///
/// - held: the position of the row before once more;
/// - interpolated: a row in the middle of its neighbours to the last digit written, or with the
///   second difference of the row before, as points between two measured ones, or carried on from
///   them, have. Chance makes such rows too, the more the coarser the coordinates are: how many it
///   makes is estimated from the scatter of the third differences, and stated beside them.
///
/// `position_resolution_m` is the smallest step of the coordinates, 0 where it is not known.
/// Linear in the rows; marks nothing.
DeviceSigns find_device_signs(const std::vector<ScreenedEpoch>& rows, double nominal_interval_s,
                              double position_resolution_m);

}  // namespace runcert
