#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/enu/frame_origin.h"
#include "schemas/trajectory/declared.h"
#include "surface/triangulation.h"
#include "witness/runs.h"

namespace runcert {

/// A figure with its expanded uncertainty (k = 2), in the figure's unit. Empty if unknown.
struct CourseFigure {
    double value = 0.0;
    std::optional<double> expanded_uncertainty;
};

/// Errors that the trajectory's own standard uncertainties do not include, and the limits of a
/// standstill.
struct CourseErrors {
    /// Standard uncertainties of errors that are constant at one place but may differ between
    /// places of a run: m, horizontally for each coordinate, and vertically.
    double slow_horizontal_m = 0.0;
    double slow_vertical_m = 0.0;
    /// Whether "up" is above the plane that touches the Earth at the origin, below which the Earth
    /// falls away. False for a recording in engineering coordinates.
    bool tangent_plane = true;
    double standing_below_m_s = 0.2;  ///< below this at rest, however small the uncertainty
    double moving_above_m_s = 1.0;    ///< above this never at rest, however large the uncertainty
};

/// Facts about the course and the start of one run, from the trajectory.
struct CourseFacts {
    /// Highest minus lowest smoothed height in the run. Noise raises the highest and lowers the
    /// lowest, so it is too large rather than too small, by up to a few times the standard
    /// uncertainty of a smoothed height. Its uncertainty does not cover that. Heights are
    /// ellipsoidal: the geoid's own slope, some centimetres per kilometre, is included.
    std::optional<CourseFigure> height_difference_m;
    /// Height gained over distance between the window's ends, positive upwards.
    std::optional<CourseFigure> slope;
    /// Direction of the window's displacement, clockwise from north, 0 to below 360.
    CourseFigure heading_deg;
    /// Largest distance of the track in the window from the straight line through its ends. Never
    /// negative: noise alone makes it some standard uncertainties of a position.
    CourseFigure straightness_m;
    /// Direction of travel at the window's end less that at its beginning, -180 to 180, + right.
    CourseFigure turning_deg;
    /// Smallest speed from the standing that the run began with (from the run's beginning where it
    /// began otherwise) to the window's first row. A run's first row is just below the cut.
    CourseFigure speed_before_m_s = {};
    /// Whether that speed is of a craft at rest. It is if below `standing_below_m_s`. It is also if
    /// not above `moving_above_m_s` and the velocity v, of covariance C, is within its uncertainty
    /// of zero: v' C^-1 v is at most the chi-squared quantile of 95 % with 2 degrees of freedom.
    bool standing_start = false;
    double run_up_m = 0.0;  ///< path length from the run's beginning to the window's
    double run_up_s = 0.0;  ///< its duration
};

/// The facts of a run and a window in it, from rows of one trajectory. Heights above a tangent
/// plane are corrected by (e^2 + n^2) / 2R, R = 6371 km, good to 0.6 % of that: 5 cm at 10 km.
/// Heights give no facts unless every estimate of the run has one.
///
/// Uncertainties: positions at distant times are taken as independent, which they nearly are, each
/// with its row's variance and that of the time-correlated errors. Velocity components are taken as
/// uncorrelated. The uncertainty of a speed is the larger of its components', because near zero its
/// direction is noise. Those of angles are at most 180 degrees, where nothing is known.
///
/// Failure if a given row is not in the trajectory, the window is not in the run, or an end of
/// either has no estimate.
CourseFacts course_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                         std::size_t window_first_row, std::size_t window_last_row,
                         const CourseErrors& errors);

/// The surface that a craft ran on, in the run's frame.
struct CourseGround {
    Triangulation surface;
    double vertical_sd_m = 0.0;  ///< of its vertices
};

/// What the surface says of the course under the craft.
struct GroundFacts {
    CourseFigure height_difference_m;  ///< highest minus lowest ground under the run
    CourseFigure slope;                ///< of the ground under the window's ends, upwards positive
};

/// The facts of the ground under a run and a window in it, straight below each estimate of the
/// antenna; heights above a tangent plane are corrected as for `course_facts`. Errors of two
/// heights are taken as independent, each of the vertices' stated size. Nothing where an estimate
/// of the run does not lie over the surface, or the window's ends lie at one place.
std::optional<GroundFacts> ground_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                                        std::size_t window_first_row, std::size_t window_last_row,
                                        const CourseGround& ground,
                                        const std::optional<FrameOrigin>& origin);

/// Signs of the device's filter in the smoothed motion. After a change of the acceleration along
/// the track it oscillates about its final value. Each swing is a fraction of the previous one,
/// with the same rhythm every time. A craft may do so once; a filter always does.
struct Overshoot {
    std::int64_t changes = 0;  ///< number of changes of the acceleration that were examined
    std::int64_t swings = 0;   ///< number of these that such an oscillation follows
    double period_s = 0.0;     ///< median of the swings' periods; 0 without any
    double part = 0.0;         ///< median ratio of the first swing to the change

    /// At least two, and most of those examined.
    bool found() const { return swings >= 2 && 2 * swings > changes; }
};

/// Examines every change of the acceleration along the track by 1 m/s^2 or more whose last three
/// quarters take at most 4 s, where the craft is faster than 2 m/s. The cost is linear.
Overshoot find_overshoot(const std::vector<TrajectoryEpoch>& rows);

}  // namespace runcert
