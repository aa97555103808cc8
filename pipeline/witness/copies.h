#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/timed_value.h"
#include "schemas/screened/screened.h"
#include "witness/recorded_velocities.h"

// Detects witnesses that were made from the positions or from another witness. A copy adds no
// evidence: it agrees with the positions whatever their errors are.
//
// An independent witness departs from the positions by at least their own errors. What was made
// from them lacks a part of these errors, in the band that its making left in. `made_from` asks
// this of each kind of data.

namespace runcert {

/// The motion is taken as unknown between speeds further apart than this (s).
inline constexpr double longest_between_speeds_s = 2.5;

/// The step (m/s) that all speeds are multiples of. `finest_m_s` where it is finer or cannot be
/// seen: few devices write speeds finer than 0.01 m/s, and a rotation of the axes hides the step.
double resolution_m_s(std::span<const TimedValue> speeds, double finest_m_s = 0.01);

/// Whether speeds (m/s) of any scale are a difference, mean or filter of these positions.
/// `unclear` if there are too few, or if their rounding would hide it.
///
/// Each speed is regressed on the displacements between up to 32 rows on either side. Positions
/// with white errors of variance s^2 leave an independent speed a residual of variance s^2 |h|^2 or
/// more, with h the weights of the positions that the regression finds; speeds made from them leave
/// their rounding. Less than a fifth of this noise, beyond rounding, shows a copy. Differences of
/// third order are compared alike, in which smooth disguises drop out.
///
/// Times of the speeds are those of the positions plus `delay_s`. `resolution_m` is the rounding of
/// the positions. Only rows where the craft moves at half the speed of its fastest tenth or more
/// count. Positions may also be integrated speeds.
VelocityOrigin made_from(std::span<const TimedValue> speeds,
                         std::span<const TimedPosition<2>> positions, double delay_s = 0.0,
                         double resolution_m = 0.0);

/// Whether one of two receivers' positions were made from the other's, in the sense of the speeds
/// between neighbours. `offset_s` is added to the second's times.
bool made_from(std::span<const TimedPosition<2>> second, std::span<const TimedPosition<2>> first,
               double offset_s);

/// Whether integrated speeds stay with the positions as smoothed ones do, which rounding hides from
/// the regression. They then depart from them by the positions' white noise, over long spans no
/// more than over short ones, and by less than measured ones do: the best receivers observed leave
/// 7 mm after a second, and that times the square root of the time later. Less than 3 mm over
/// spans of 10 s and more is not credible; for code positions, which wander themselves,
/// neither is less than 0.1 m after 100 s. An exact witness departs over long spans by the slow
/// errors of the positions. `rounding_m_s` is the standard deviation of the rounding of the samples
/// that were integrated, `interval_s` their spacing.
bool made_from(const Witness<2>& integrated, double rounding_m_s, double interval_s,
               std::span<const TimedPosition<2>> positions);

/// The length of a craft's path over a time span.
struct Way {
    TimeSpan span;
    double length_m = 0.0;
    double sigma_m = 0.0;  ///< standard uncertainty claimed for it; 0: none
};

/// Whether path lengths match those between positions, interpolated linearly, more closely than
/// chance does once in a hundred times (chi-squared, lower tail), given the positions' white noise.
bool made_from(std::span<const Way> ways, std::span<const TimedPosition<2>> positions);

/// Data that a witness may have been made from, in the form of positions.
struct WitnessSource {
    std::string name;  ///< "the recorded velocities", "receiver "b""
    std::vector<TimedPosition<2>> positions = {};
    double delay_s = 0.0;                     ///< by how much their times are late
    std::vector<TimedValue> speeds_m_s = {};  ///< speeds that the positions are the integral of, if
                                              ///< any
};

/// The integral of the recorded velocities. Empty if screening did not determine their errors.
std::optional<WitnessSource> source_by_velocities(const ScreenedTable& screened,
                                                  const Directions& directions);
/// The positions of another receiver. Empty if the times of the two cannot be compared.
std::optional<WitnessSource> source_by_receiver(const ScreenedTable& screened,
                                                const ScreenedTable& other);

/// The name of the source that speeds delayed by `delay_s`, or the lengths of these ways, were made
/// from. Empty if they were measured independently.
std::optional<std::string> source_of(std::span<const TimedValue> speeds_m_s,
                                     std::span<const WitnessSource> sources, double delay_s);
std::optional<std::string> source_of(std::span<const Way> ways,
                                     std::span<const WitnessSource> sources);

/// "The wheel's speeds were made from the recorded velocities. ..."
std::string copy_text(std::string_view what, std::string_view source);

}  // namespace runcert
