#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/timed_value.h"
#include "witness/track.h"
#include "witness/velocity_witness.h"

namespace runcert {

/// A run: fast stretches with less than a minute between them.
struct WheelRun {
    TimeSpan span;
    PositionVector<2> direction = PositionVector<2>::Zero();  ///< sum of the velocities in the run
    double scale = 1.0;  ///< factor with which the witness's speeds fit the positions there
};

/// The factor on a wheel's speeds.
struct WheelScale {
    double value = 1.0;
    double sigma = 0.0;        ///< relative standard uncertainty
    bool independent = false;  ///< false: it was also fitted to the window and absorbs its drift
};

/// A wheel's speeds along the track as a witness.
///
/// A scale fitted to the window's own positions would absorb any drift proportional to the speed.
/// The scale is therefore the calibrated one, or else the mean of the other runs, both directions
/// weighted equally where runs go both ways. Its uncertainty is the scatter of the runs (Student's
/// t, at least 0.1 %), for the mean and for the run that it is applied to. With fewer than two
/// other runs, the scale is fitted to all runs, and the motion confirms nothing.
class WheelMotion final : public Witness<2> {
  public:
    /// `motion` uses speeds multiplied by the calibrated scale, or by the one fitted to all, and
    /// does not include its uncertainty. That is `sigma_scale`.
    WheelMotion(VelocityWitness<2> motion, std::vector<WheelRun> runs, double sigma_scale,
                bool calibrated);

    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override { return motion_.covered(); }
    std::optional<double> path_between(double from_s, double to_s) const override;

    /// The scale for a window, relative to that of the speeds as given. `displacement_m` gives the
    /// window's direction of travel.
    WheelScale scale_for(double from_s, double to_s, const PositionVector<2>& displacement_m) const;

  private:
    VelocityWitness<2> motion_;
    std::vector<WheelRun> runs_;
    double sigma_scale_;
    bool calibrated_;
};

/// A wheel's speed as a witness, with the parameters estimated from the positions.
struct WheelWitness {
    WheelMotion motion;
    double scale = 1.0;  ///< best fit to the positions of the whole recording
    double sigma_scale = 0.0;
    double delay_s = 0.0;  ///< of its speeds relative to the positions
    double sigma_delay_s = 0.0;
    bool made_from_positions = false;  ///< it has the positions' errors (`made_from`)
};

/// A wheel's speeds, m/s, and its stated scale, if any.
struct WheelSpeeds {
    std::vector<TimedValue> m_s;
    std::optional<double> calibrated_scale = {};
    double sigma_calibrated = 0.0;  ///< relative standard uncertainty of the calibrated scale
};

/// A wheel's speed along the direction of travel as a witness. Its delay, within a second either
/// way, is that with which its speeds best fit those of the track. Its scale is the calibrated one
/// or that of other runs (`WheelMotion`). Its errors are estimated against the positions, as for
/// recorded velocities. Without a calibration it cannot reveal a lasting scale error of the
/// positions. Empty if fewer than 30 epochs of the track have a wheel speed, or nothing bounds
/// its errors.
std::optional<WheelWitness> wheel_witness(const WheelSpeeds& speeds,
                                          std::span<const TimedPosition<2>> positions,
                                          const Track& track, double jerk_density);

/// Fast stretches belong to one run if less time (s) than this separates them.
inline constexpr double between_runs_s = 60.0;

}  // namespace runcert
