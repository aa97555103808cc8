#pragma once

#include <optional>
#include <span>

#include "stages/window/velocity_moment.h"

// Errors of recorded speeds, from comparison with the positions of the recording.

namespace runcert {

/// Least lasting error assumed (m/s), whatever a comparison shows.
inline constexpr double least_slow_error_m_s = 0.05;

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

/// A relative error that all recorded speeds of a recording have in common.
struct SpeedScale {
    double value = 0.0;        ///< the best estimate, taken off the speed
    double uncertainty = 0.0;  ///< its standard uncertainty
    double shown = 0.0;        ///< what the comparison with the positions alone shows
    double shown_uncertainty = 0.0;
};

/// The scale of the recorded speeds beside the path of the smoothed track, over spans of 10 s as
/// for `span_spread`. Neighbouring spans err alike, so that a third of them count as independent.
/// What they show is weighed against the prior of receivers: `scale_priors`. Empty without five
/// spans.
std::optional<SpeedScale> speed_scale(std::span<const ComparedSpeed> compared);

/// Root mean square difference between the mean recorded speed over `span_s`, less its `scale`,
/// and the smoothed path over time. Spans do not overlap, and the craft must move straight (a chord
/// of 95 % of the path), at half the speed of its fastest tenth or more. Spans that are not
/// straight count as well where fewer than five are. Empty for fewer than five spans.
std::optional<SpeedSpread> span_spread(std::span<const ComparedSpeed> compared, double span_s,
                                       double scale = 0.0);

/// The errors of a recording's speeds, for windows of one length.
struct SpeedNoise {
    std::optional<SpeedSpread> white;
    std::optional<SpeedSpread> over_window;  ///< only for windows shorter than ten seconds
    std::optional<SpeedSpread> over_ten;     ///< over spans of 10 s
    std::optional<SpeedScale> scale = {};    ///< empty if the comparison tells nothing of it
    /// Of the mean speed over 10 s by positions, m/s: what twice their stated standard deviation at
    /// both ends makes. Nearly all that they could err by.
    double positions_m_s = 0.0;
    /// The positions follow the velocities, or the reverse, so that they have errors in common.
    bool in_common = false;

    /// Whether the comparison tells the errors of windows of this length. If not, what is stated
    /// counts whole.
    bool is_shown(double duration_s) const;
};

/// The speed noise for a window from `start_s` over `duration_s`, with `samples` over which white
/// noise may average. Errors are in common where screening says so. They are also in common where
/// the two agree too well: over spans as long as the window (10 s at most) better than the white
/// noise allows, beyond chance; or over 10, 30 and 100 s by less than a quarter of what the
/// positions state of a displacement, which wander by more on their own. Such positions tell
/// nothing of the scale either.
SpeedNoise speed_noise(std::span<const ComparedSpeed> compared, const ScreenedTable& screened,
                       Dimension dimension, double start_s, double duration_s, double samples);

/// The stated standard uncertainty of a recorded speed (m/s), by the receiver or by the attempt. A
/// statement of the attempt never makes a speed more certain than the recording shows.
struct StatedSpeedAccuracy {
    double sigma_m_s = 0.0;
    bool claimed = false;
    double scatter_m_s = 0.0;  ///< from the smoothed motion, as found by screening
    /// Of the window's mean, from single samples that are stated to be much worse than the others.
    double of_worse_m_s = 0.0;
};

/// What determines the lasting error of a speed.
enum class SlowError { floor, shown, stated };

/// Standard uncertainties of a window's mean recorded speed, m/s.
struct SpeedErrors {
    double white_m_s = 0.0;       ///< of one sample
    double mean_white_m_s = 0.0;  ///< of the mean, from white noise
    double brief_m_s = 0.0;       ///< of the mean, from errors shorter than ten seconds
    double slow_m_s = 0.0;        ///< assumed to be one error throughout the window
    SlowError slow = SlowError::stated;

    double combined() const;
};

/// The errors for a window of `samples` over `duration_s`. With sigma the white noise, and D_T and
/// D_10 the spreads over the window and over 10 s:
///
///     slow = max(0.05 m/s, D_10), and not below the stated value where positions may err by more
///     white^2 + brief^2 = max(sigma^2 / samples, D_T^2 - D_10^2) below 10 s,
///                         else sigma^2 / samples
///
/// What is stated caps nothing. Where nothing is shown, or errors are in common, it counts in full;
/// an attempt's own statement then counts as at least the scatter and 0.05 m/s. White noise above
/// an attempt's statement contradicts it, and does not average.
SpeedErrors speed_errors(const SpeedNoise& noise, const StatedSpeedAccuracy& stated,
                         double duration_s, double samples);

}  // namespace runcert
