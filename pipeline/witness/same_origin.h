#pragma once

#include <span>

#include "witness/velocity_origin.h"
#include "witness/witnessed_spans.h"

// Data made from the positions share their errors. They agree with the positions whatever these
// errors are, and are no witness. Each function tests one kind of data for this. Rows are in order
// of time.

namespace runcert {

/// Whether the positions of two receivers have the same errors. That is so where the white noise of
/// their difference is less than half that of either; with independent errors it is larger than
/// both. The first receiver's positions are interpolated linearly, so that a copy at other instants
/// is also found. `offset_s` is added to the second's times. False if fewer than 30 rows of the
/// second have neighbours in the first.
bool share_errors(std::span<const velocities::SpeedBesidePosition> first,
                  std::span<const velocities::SpeedBesidePosition> second, double offset_s);

/// Whether recorded speeds are a weighted mean of the displacements between neighbouring rows, as
/// smoothing, differencing or filtering of positions gives them. Least squares finds the weights,
/// over 8 or 32 rows on either side and in the direction of travel.
///
/// Independently measured speeds leave residuals of at least the white noise that their differences
/// show (0.4 to 10 times it on recordings of receivers). Speeds made from positions leave a
/// hundredth of it. The limit is a fifth. Only rows where the craft moves at half the speed of its
/// fastest tenth or more count. False if there are too few.
bool are_filtered_positions(std::span<const velocities::SpeedBesidePosition> rows);

/// Whether integrated speeds follow the positions more closely than any measured ones do. Errors of
/// measured speeds accumulate: the best receivers observed leave 7 mm after a second, and that
/// times the square root of the time later. Less than 3 mm over spans of 10 s and more is not
/// credible. For code positions (`of_code`), which wander themselves, neither is less than 0.1 m
/// after 100 s.
bool keep_to_positions(std::span<const DisplacementSpread> spreads, bool of_code);

/// Whether differences, in units of their own standard uncertainty, are smaller than chance makes
/// them once in a hundred times (chi-squared, lower tail).
bool agree_too_well(std::span<const double> normalised_differences);

}  // namespace runcert
