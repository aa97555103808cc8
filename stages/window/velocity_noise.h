#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/profile/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "witness/certifiable.h"

// How much recorded speeds err, as the recording shows it beside its positions.

namespace runcert {

/// Errors that last are not taken to be smaller (m/s), whatever a comparison shows.
inline constexpr double least_slow_error_m_s = 0.05;

/// A recorded speed beside the smoothed track of the same moment.
struct ComparedSpeed {
    double time_s = 0.0;
    double recorded_m_s = 0.0;
    double smoothed_m_s = 0.0;
    double recorded_m = 0.0;   ///< way by recorded speeds, from any beginning
    double smoothed_m = 0.0;   ///< way along the smoothed track
    std::int64_t stretch = 0;  ///< those of different ones are not compared
};

/// Those of all usable epochs whose speed is of their own moment, in order of time. A stretch ends
/// with its arc, at a bridged step, at an epoch that is left out and at a step longer than a second
/// and than one and a half intervals.
std::vector<ComparedSpeed> compared_speeds(const ScreenedTable& screened,
                                           const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs, Dimension dimension);

/// A standard deviation (m/s) that so many independent differences show.
struct SpeedSpread {
    double sd_m_s = 0.0;
    double independent = 0.0;
};

/// The white noise of a recorded speed: the smaller of what the steps, between neighbours, of
/// recorded less smoothed speed show and what third differences of the recorded speeds do, both
/// robustly. The first hold the positions' noise, the others what the craft did. Of the samples
/// within 30 s of `from_s` to `to_s`; of all where fewer than 30 differences lie there, and nothing
/// where these are too few, too.
std::optional<SpeedSpread> white_noise(std::span<const ComparedSpeed> compared, double from_s,
                                       double to_s);

/// Root mean square of what the mean recorded speed over `span_s` differs by from the smoothed
/// path over time, of spans that do not overlap and during which the craft moved at half the speed
/// of its fastest tenth or more. Nothing where these are fewer than five.
std::optional<SpeedSpread> span_spread(std::span<const ComparedSpeed> compared, double span_s);

/// What a recording shows of its speeds' errors, for windows of one length.
struct SpeedNoise {
    std::optional<SpeedSpread> white;
    std::optional<SpeedSpread> over_window;  ///< windows shorter than ten seconds alone
    std::optional<SpeedSpread> over_ten;     ///< over 10 s
    /// The positions follow the velocities, or these the positions: the two have errors in common.
    bool in_common = false;
};

/// Where a window has `samples` of them over `duration_s` within which white noise may average.
/// In common: screening says so, or over as long as the window (10 s at most) the two keep to one
/// another better than the white noise lets them, by more than chance makes.
SpeedNoise speed_noise(std::span<const ComparedSpeed> compared, const ScreenedTable& screened,
                       double start_s, double duration_s, double samples);

/// What is stated of a recorded speed's accuracy (standard uncertainty, m/s): by the receiver, or
/// by the attempt, whose word never makes a speed surer than the recording shows it.
struct StatedSpeedAccuracy {
    double sigma_m_s = 0.0;
    bool claimed = false;
    double scatter_m_s = 0.0;  ///< from the smoothed motion, as screening saw it
};

/// What decides the lasting error of a speed.
enum class SlowError { floor, shown, stated };

/// Standard uncertainties of a window's mean recorded speed, m/s.
struct SpeedErrors {
    double white_m_s = 0.0;         ///< of one sample
    double mean_white_m_s = 0.0;    ///< of the mean
    double brief_m_s = 0.0;         ///< of the mean, by errors shorter than ten seconds
    double slow_m_s = 0.0;          ///< taken as one error throughout the window
    double slow_between_m_s = 0.0;  ///< what of it may differ between windows
    SlowError slow = SlowError::stated;

    double combined() const;
};

/// For a window of `samples` over `duration_s`. With sigma the white noise, D_T and D_10 the
/// spreads over the window and over 10 s:
///
///     slow = min(stated, max(0.05 m/s, D_10))
///     white^2 + brief^2 = max(sigma^2 / samples, D_T^2 - D_10^2) below 10 s, else sigma^2 /
///     samples
///
/// and all together never more than a receiver states, beside its white noise. Where nothing is
/// shown, or both have their errors in common, what is stated counts whole. An attempt's own
/// statement then counts no less than the scatter and 0.05 m/s, and else not at all: only where the
/// white noise contradicts it, that does not average.
SpeedErrors speed_errors(const SpeedNoise& noise, const StatedSpeedAccuracy& stated,
                         double duration_s, double samples);

/// The standard deviation of a white noise from the lengths of its differences, which have `gain`
/// times its variance (2 of first differences, 20 of third ones), by their median: robust.
double robust_sd(std::vector<double> absolute, double gain);

}  // namespace runcert
