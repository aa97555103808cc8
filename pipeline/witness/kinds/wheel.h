#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/timed_value.h"
#include "witness/track.h"
#include "witness/velocity_witness.h"

namespace runcert {

/// Fast stretches with less than a minute between them.
struct WheelRun {
    TimeSpan span;
    PositionVector<2> direction = PositionVector<2>::Zero();  ///< sum of its velocities
    double scale = 1.0;  ///< that the witness's speeds fit the positions there with
};

/// What a wheel's speeds are multiplied by.
struct WheelScale {
    double value = 1.0;
    double sigma = 0.0;        ///< relative standard uncertainty
    bool independent = false;  ///< false: fitted to the window, too, whose drift it takes in
};

/// A wheel's speeds along the track as a witness. A scale that is fitted to a window's own
/// positions takes in whatever drifts there in proportion to the speed. Therefore it is the
/// calibrated one, or else that of the other runs: their mean, where they go both ways that of
/// both. Its uncertainty is what runs differ by (Student's t, at least 0.1 %), for the mean and for
/// the run that it is applied to. With fewer than two other runs it is the one fitted to all, and
/// the motion confirms nothing.
class WheelMotion final : public Witness<2> {
  public:
    /// `motion`: by speeds that are multiplied by the calibrated scale, or the one fitted to all,
    /// of which `sigma_scale` is the uncertainty; it has none of its own.
    WheelMotion(VelocityWitness<2> motion, std::vector<WheelRun> runs, double sigma_scale,
                bool calibrated);

    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override { return motion_.covered(); }
    std::optional<double> path_between(double from_s, double to_s) const override;

    /// Of a window, relative to that of the speeds as given; `moved` says in which direction.
    WheelScale scale_for(double from_s, double to_s, const PositionVector<2>& moved) const;

  private:
    VelocityWitness<2> motion_;
    std::vector<WheelRun> runs_;
    double sigma_scale_;
    bool calibrated_;
};

/// A wheel's speed as a witness, and what was estimated of it beside the positions.
struct WheelWitness {
    WheelMotion motion;
    double scale = 1.0;  ///< that fits the positions of the whole recording best
    double sigma_scale = 0.0;
    double delay_s = 0.0;  ///< of its speeds behind the positions
    double sigma_delay_s = 0.0;
    bool made_from_positions = false;  ///< it has their errors (`keep_to_positions`, or as recorded
                                       ///< speeds that are differences of the positions)
};

/// Speeds of a wheel, m/s, and the scale that was stated for it.
struct WheelSpeeds {
    std::vector<TimedValue> m_s;
    std::optional<double> calibrated_scale = {};
    double sigma_calibrated = 0.0;  ///< relative standard uncertainty of that
};

/// The speed of a wheel along the direction of travel. Its delay (within a second either way) is
/// that with which its speeds fit those of the track best; its scale the calibrated one, or that of
/// other runs (`WheelMotion`); its errors are estimated beside the positions, as those of recorded
/// velocities are. A wrong scale of the positions that lasts it cannot see without a calibration.
/// Nothing where fewer than 30 epochs of the track have a speed of the wheel, or nothing bounds its
/// errors.
std::optional<WheelWitness> wheel_witness(const WheelSpeeds& speeds,
                                          std::span<const TimedPosition<2>> positions,
                                          const Track& track, double jerk_density);

/// Two fast stretches are of one run where less time (s) than this lies between them.
inline constexpr double between_runs_s = 60.0;

}  // namespace runcert
