#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/profile/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "witness/certifiable.h"

// Errors of recorded speeds, from comparison with the positions of the recording.

namespace runcert {

/// Least lasting error assumed (m/s), whatever a comparison shows.
inline constexpr double least_slow_error_m_s = 0.05;

/// A recorded speed and the smoothed track at the same moment.
struct ComparedSpeed {
    double time_s = 0.0;
    double recorded_m_s = 0.0;
    double smoothed_m_s = 0.0;
    double recorded_m = 0.0;   ///< distance by integrating recorded speeds, from an arbitrary start
    double smoothed_m = 0.0;   ///< distance along the smoothed track
    std::int64_t stretch = 0;  ///< samples of different stretches are not compared
};

/// The compared speeds of all usable epochs whose speed belongs to their own moment, in order of
/// time. A stretch ends with its arc, at a bridged step, at an epoch that is left out, and at a
/// step longer than a second and than one and a half intervals.
std::vector<ComparedSpeed> compared_speeds(const ScreenedTable& screened,
                                           const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs, Dimension dimension);

/// A standard deviation (m/s) and the number of independent differences behind it.
struct SpeedSpread {
    double sd_m_s = 0.0;
    double independent = 0.0;
};

/// The white noise of a recorded speed. It is the smaller of two robust estimates: from the
/// differences between neighbours of recorded minus smoothed speed, and from third differences of
/// the recorded speeds. The first contain the positions' noise, the second the craft's motion.
/// Samples are those within 30 s of `from_s` to `to_s`, or all where fewer than 30 differences lie
/// there. Empty if these are also too few.
std::optional<SpeedSpread> white_noise(std::span<const ComparedSpeed> compared, double from_s,
                                       double to_s);

/// Root mean square difference between the mean recorded speed over `span_s` and the smoothed path
/// over time. Spans do not overlap, and the craft must move at half the speed of its fastest tenth
/// or more. Empty for fewer than five spans.
std::optional<SpeedSpread> span_spread(std::span<const ComparedSpeed> compared, double span_s);

/// The errors of a recording's speeds, for windows of one length.
struct SpeedNoise {
    std::optional<SpeedSpread> white;
    std::optional<SpeedSpread> over_window;  ///< only for windows shorter than ten seconds
    std::optional<SpeedSpread> over_ten;     ///< over spans of 10 s
    /// The positions follow the velocities, or the reverse, so that they have errors in common.
    bool in_common = false;
};

/// The speed noise for a window from `start_s` over `duration_s`, with `samples` over which white
/// noise may average. Errors are in common where screening says so. They are also in common where,
/// over spans as long as the window (10 s at most), the two agree better than the white noise
/// allows, beyond chance.
SpeedNoise speed_noise(std::span<const ComparedSpeed> compared, const ScreenedTable& screened,
                       double start_s, double duration_s, double samples);

/// The stated standard uncertainty of a recorded speed (m/s), by the receiver or by the attempt. A
/// statement of the attempt never makes a speed more certain than the recording shows.
struct StatedSpeedAccuracy {
    double sigma_m_s = 0.0;
    bool claimed = false;
    double scatter_m_s = 0.0;  ///< from the smoothed motion, as found by screening
};

/// What determines the lasting error of a speed.
enum class SlowError { floor, shown, stated };

/// Standard uncertainties of a window's mean recorded speed, m/s.
struct SpeedErrors {
    double white_m_s = 0.0;         ///< of one sample
    double mean_white_m_s = 0.0;    ///< of the mean, from white noise
    double brief_m_s = 0.0;         ///< of the mean, from errors shorter than ten seconds
    double slow_m_s = 0.0;          ///< assumed to be one error throughout the window
    double slow_between_m_s = 0.0;  ///< the part that may differ between windows
    SlowError slow = SlowError::stated;

    double combined() const;
};

/// The errors for a window of `samples` over `duration_s`. With sigma the white noise, and D_T and
/// D_10 the spreads over the window and over 10 s:
///
///     slow = min(stated, max(0.05 m/s, D_10))
///     white^2 + brief^2 = max(sigma^2 / samples, D_T^2 - D_10^2) below 10 s,
///                         else sigma^2 / samples
///
/// Together they never exceed the standard uncertainty that a receiver states, apart from its white
/// noise. Where nothing is shown, or errors are in common, the stated value counts in full. An
/// attempt's own statement then counts as at least the scatter and 0.05 m/s. Otherwise it is not
/// used, except where the white noise contradicts it, which then does not average.
SpeedErrors speed_errors(const SpeedNoise& noise, const StatedSpeedAccuracy& stated,
                         double duration_s, double samples);

/// The standard deviation of a white noise from the lengths of its differences, which have `gain`
/// times its variance (2 of first differences, 20 of third ones), by their median: robust.
double robust_sd(std::vector<double> absolute, double gain);

}  // namespace runcert
