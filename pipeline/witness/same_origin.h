#pragma once

#include <span>

#include "witness/velocity_origin.h"
#include "witness/witnessed_spans.h"

// What was made from the positions has their errors: it agrees with them whatever these are, and
// witnesses nothing. Each function asks this of another kind of witness. Rows in order of time.

namespace runcert {

/// Whether two receivers' positions have the same errors: the white noise of their difference is
/// less than half that of either, where independent errors make it larger than both. The first's
/// are taken linearly between its rows, so that a copy at other instants is found, too. `offset_s`
/// is added to the second's times. False where fewer than 30 rows of the second have neighbours of
/// the first.
bool share_errors(std::span<const velocities::SpeedBesidePosition> first,
                  std::span<const velocities::SpeedBesidePosition> second, double offset_s);

/// Whether recorded speeds are some weighted mean of the displacements between neighbouring rows,
/// by which smoothing, differencing or filtering positions makes them: least squares finds the
/// weights, over 8 or 32 rows on either side and in the direction of travel. Speeds measured on
/// their own keep at least the white noise that their differences show (0.4 to 10 times it on
/// recordings of receivers); made ones keep a hundredth of it. The bound is a fifth. Asked where
/// the craft moves at half the speed of its fastest tenth or more; false where too few rows do.
bool are_filtered_positions(std::span<const velocities::SpeedBesidePosition> rows);

/// Whether integrated speeds keep to the positions as none that were measured do. Errors of
/// measured ones add up: the best receivers seen leave 7 mm after a second, and that times the root
/// of the time later. Less than 3 mm is not believed, of spans of 10 s and more; nor, of
/// positions by code (`of_code`), which wander by themselves, less than 0.1 m after 100 s.
bool keep_to_positions(std::span<const DisplacementSpread> spreads, bool of_code);

/// Whether differences in units of their own standard uncertainty are so small as chance makes them
/// once in a hundred times (chi-squared, lower tail).
bool agree_too_well(std::span<const double> normalised_differences);

}  // namespace runcert
