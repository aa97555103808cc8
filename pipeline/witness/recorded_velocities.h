#pragma once

#include <optional>
#include <span>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/velocity_witness.h"

namespace runcert {

/// The direction of travel (unit vector, east and north) at each row of a table. Empty if
/// unknown. A speed recorded without a course is a velocity in this direction.
using Directions = std::vector<std::optional<Eigen::Vector2d>>;

/// The direction of a velocity (m/s) with this covariance. Empty if the craft is slower than
/// 1 m/s or three standard deviations.
std::optional<Eigen::Vector2d> direction_of(const Eigen::Vector2d& velocity,
                                            const Eigen::Matrix2d& covariance);

/// The horizontal velocity (Axes 2) or vertical rate (1) that a row records, m/s. A speed alone is
/// taken along the direction.
template <int Axes>
std::optional<PositionVector<Axes>> recorded_velocity(
    const ScreenedEpoch& row, const std::optional<Eigen::Vector2d>& direction);

/// The horizontal speed, vertical speed or speed in space of a velocity, with its first-order
/// standard uncertainty. The latter is empty if a standard deviation is missing.
struct RecordedSpeed {
    double speed_m_s = 0.0;
    std::optional<double> standard_uncertainty_m_s;
};

/// The speed from an epoch's recorded velocity, of its horizontal part (`level`), its vertical one
/// (`upright`) or both; horizontally its recorded speed where it has no course. Empty if a needed
/// value is missing.
std::optional<RecordedSpeed> recorded_speed(const RecordedVelocity& velocity, bool level,
                                            bool upright);

/// Whether the recorded velocities ever change. A field that the receiver does not fill never does.
bool recorded_velocities_change(const std::vector<ScreenedEpoch>& rows);

/// Whether each row lies in a stretch whose delay is too large to be removed, so that its recorded
/// velocity belongs to another moment.
std::vector<bool> velocities_of_other_moments(const std::vector<ScreenedEpoch>& rows,
                                              const std::optional<VelocityComparison>& velocity);

/// The same, or the tests of recorded speeds refused it. A sample that they refuse horizontally is
/// not used vertically either (`upright`: the vertical rate counts).
std::vector<bool> velocities_left_out(const std::vector<ScreenedEpoch>& rows,
                                      const std::optional<VelocityComparison>& velocity,
                                      bool upright);

/// The recorded velocities of a table, for a witness, without the rows in `left_out`. Rows are in
/// order of time. Unusable rows are included, because their velocity may be right. A stretch ends
/// where more than 2.5 s, or 2.5 intervals, have no velocity.
template <int Axes>
std::vector<TimedVelocity<Axes>> timed_velocities(const std::vector<ScreenedEpoch>& rows,
                                                  const Directions& directions,
                                                  double nominal_interval_s,
                                                  const std::vector<bool>& left_out);

/// The usable positions with their stated standard deviations. Each arc is a stretch.
template <int Axes>
std::vector<TimedPosition<Axes>> timed_positions(const std::vector<ScreenedEpoch>& rows);

/// Median of the stated standard deviations (m/s, each axis) of the recorded velocities. Empty
/// if most do not state one.
template <int Axes>
std::optional<double> stated_velocity_sigma(const std::vector<ScreenedEpoch>& rows);

/// The recorded velocities of a screened table as a witness, with the errors that screening found.
/// Empty if there are none, or nothing bounds their errors.
template <int Axes>
std::optional<VelocityWitness<Axes>> velocity_witness(const ScreenedTable& table,
                                                      const Directions& directions);

/// The error model that screening reports.
VelocityErrorModel model_of(const VelocityErrors& errors);

}  // namespace runcert
