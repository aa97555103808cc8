#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/trajectory/trajectory.h"
#include "witness/runs.h"

namespace runcert {

/// A figure with its expanded uncertainty (k = 2), in the figure's unit; empty: not known.
struct CourseFigure {
    double value = 0.0;
    std::optional<double> expanded_uncertainty;
};

/// What the trajectory's own standard uncertainties do not hold, and the limits of a standstill.
struct CourseErrors {
    /// Standard uncertainties of errors that stay over a run, but may differ between its places:
    /// m, horizontally for each coordinate, and vertically.
    double slow_horizontal_m = 0.0;
    double slow_vertical_m = 0.0;
    /// Whether "up" is above the plane that touches the Earth at the origin, so that the Earth
    /// falls away from it. False for a recording in engineering coordinates.
    bool tangent_plane = true;
    double standing_below_m_s = 0.2;  ///< at rest, however small the uncertainty
    double moving_above_m_s = 1.0;    ///< never at rest, however large the uncertainty
};

/// What a trajectory says of the course and of the start of one run.
struct CourseFacts {
    /// Highest minus lowest smoothed height in the run. Noise makes the highest higher and the
    /// lowest lower, so it is too large rather than too small: by up to a few times the standard
    /// uncertainty of a smoothed height. Its uncertainty does not cover that. Heights are above
    /// the ellipsoid: the geoid's own slope, some centimetres a kilometre, is part of it.
    std::optional<CourseFigure> height_difference_m;
    /// Height gained over distance, between the window's ends; upwards positive.
    std::optional<CourseFigure> slope;
    /// Direction of the window's displacement, from north over east, 0 up to 360.
    CourseFigure heading_deg;
    /// Largest distance of the track in the window from the straight line through its ends. Never
    /// negative: noise alone makes it some standard uncertainties of a position.
    CourseFigure straightness_m;
    /// Direction of travel at the window's end less that at its beginning, -180 to 180, + right.
    CourseFigure turning_deg;
    /// Smallest speed from the standing that the run began with (from the run's beginning where it
    /// began otherwise) to the window's first row. A run's first row is just below the cut.
    CourseFigure speed_before_m_s = {};
    /// Whether that speed is of a craft at rest: below `standing_below_m_s`, or not above
    /// `moving_above_m_s` and its velocity v, of covariance C, within its uncertainty of zero:
    /// v' C^-1 v at most the chi-squared quantile of 95 % with 2 degrees of freedom.
    bool standing_start = false;
    double run_up_m = 0.0;  ///< path from the run's beginning to the window's
    double run_up_s = 0.0;  ///< and its time
};

/// The facts of a run and a window in it, from rows of one trajectory. Heights of a tangent plane
/// are corrected by (e^2 + n^2) / 2R, R = 6371 km, good to 0.6 % of that: 5 cm at 10 km. They say
/// nothing unless every estimate of the run has one.
///
/// Uncertainties: positions far apart in time are taken as independent, which they are not quite,
/// each with its row's variance and that of the time-correlated errors; velocity components as
/// uncorrelated. A speed's is the larger of its components': near zero its direction is noise.
/// Angles' are at most 180 degrees, where nothing is known of them. At bridged steps the offset is
/// taken off by what the velocity says, whose uncertainty is added.
///
/// Failure where a row named is not in the trajectory, the window not in the run, or an end of
/// either has no estimate.
CourseFacts course_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                         std::size_t window_first_row, std::size_t window_last_row,
                         const CourseErrors& errors);

/// Signs of a filter of the device in the smoothed motion: after a change of the acceleration along
/// the track it swings about where it settles, each swing a fraction of the one before, in the same
/// rhythm every time. A craft may do so once; a filter does it always.
struct Overshoot {
    std::int64_t changes = 0;  ///< of the acceleration, that were looked at
    std::int64_t swings = 0;   ///< of these, those after which it swings so
    double period_s = 0.0;     ///< median of the swings' periods; 0 without any
    double part = 0.0;         ///< median of the first swing's part of the change

    /// Two at least, and most of those looked at.
    bool found() const { return swings >= 2 && 2 * swings > changes; }
};

/// Looks at every change of the acceleration along the track by 1 m/s^2 or more, of which the last
/// three quarters take 4 s at most, where the craft is faster than 2 m/s. Linear.
Overshoot find_overshoot(const std::vector<TrajectoryEpoch>& rows);

}  // namespace runcert
