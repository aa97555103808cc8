#pragma once

#include <vector>

#include "schemas/screened/screened.h"

namespace runcert {

/// Looks for positions that no receiver measured, among the rows with a position, in the order of
/// the recording. The craft must move at 1 m/s or more (over five rows before and after):
///
/// - held: the position of the previous row is repeated;
/// - interpolated: a row is midway between its neighbours to the last digit written, or has the
///   second difference of the previous row, as points interpolated between or extrapolated from
///   measured ones do. Such rows also occur by chance, more often with coarser coordinates. Their
///   expected number is estimated from the scatter of the third differences and reported beside
///   them. Where the fourth differences exceed rounding at every nth row alone (n from 4 to 50),
///   all others lie on lines or cubics (splines) between those, which chance does not make.
///
/// `position_resolution_m` is the smallest step of the coordinates, 0 if unknown. The cost is
/// linear in the rows. Marks nothing.
DeviceSigns find_device_signs(const std::vector<ScreenedEpoch>& rows, double nominal_interval_s,
                              double position_resolution_m);

}  // namespace runcert
