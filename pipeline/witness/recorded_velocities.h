#pragma once

#include <optional>
#include <span>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/velocity_witness.h"

namespace runcert {

/// The direction of travel (east, north; a unit vector) at each row of a table; nothing where it is
/// not known. A speed that is recorded without a course is a velocity along it.
using Directions = std::vector<std::optional<Eigen::Vector2d>>;

/// The direction of a velocity (m/s) of this covariance; nothing where the craft is slower than a
/// metre a second or three standard deviations.
std::optional<Eigen::Vector2d> direction_of(const Eigen::Vector2d& velocity,
                                            const Eigen::Matrix2d& covariance);

/// The horizontal velocity (Axes 2) or the vertical rate (1) that a row records; of a speed alone,
/// along the direction.
template <int Axes>
std::optional<PositionVector<Axes>> recorded_velocity(
    const ScreenedEpoch& row, const std::optional<Eigen::Vector2d>& direction);

/// Whether the recorded velocities ever change: a field that the receiver does not fill does not.
bool recorded_velocities_change(const std::vector<ScreenedEpoch>& rows);

/// Whether each row lies in a stretch whose delay is not taken off: its recorded velocity is of
/// another moment.
std::vector<bool> velocities_of_other_moments(const std::vector<ScreenedEpoch>& rows,
                                              const std::optional<VelocityComparison>& velocity);

/// What a table records, for a witness, without the rows left out: rows in order of time, also
/// those that are not usable, whose velocity may be right. A stretch ends where more than 2.5 s, or
/// intervals, are without one.
template <int Axes>
std::vector<TimedVelocity<Axes>> timed_velocities(const std::vector<ScreenedEpoch>& rows,
                                                  const Directions& directions,
                                                  double nominal_interval_s,
                                                  const std::vector<bool>& left_out);

/// The usable positions, with what is stated of them; a stretch is an arc.
template <int Axes>
std::vector<TimedPosition<Axes>> timed_positions(const std::vector<ScreenedEpoch>& rows);

/// Median of the stated standard deviations (m/s, each axis) of the recorded velocities; nothing
/// where most do not state one.
template <int Axes>
std::optional<double> stated_velocity_sigma(const std::vector<ScreenedEpoch>& rows);

/// The recorded velocities of a screened table with the errors that screening found; nothing where
/// there are none, or nothing bounds their errors.
template <int Axes>
std::optional<VelocityWitness<Axes>> velocity_witness(const ScreenedTable& table,
                                                      const Directions& directions);

/// The error model as screening states it.
VelocityErrorModel model_of(const VelocityErrors& errors);

}  // namespace runcert
