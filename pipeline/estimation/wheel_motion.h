#pragma once

#include <vector>

#include "estimation/velocity_witness.h"

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

/// Two fast stretches are of one run where less time (s) than this lies between them.
inline constexpr double between_runs_s = 60.0;

}  // namespace runcert
