#include "simulated_arc.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "estimation/motion_model.h"
#include "simulation/logistic_run.h"

namespace runcert {
namespace {

Eigen::Vector2d normals(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

/// Random motion of white-noise jerk, both axes, from rest at the origin.
class RandomMotion {
  public:
    RandomMotion(double jerk_density, double dt_s) {
        EstimationModel model;
        model.motion.jerk_density = 1.0;
        const AxisStep step = axis_step(model, dt_s);
        transition_ = step.transition;
        factor_ = jerk_density * Eigen::Matrix3d(step.process_noise.llt().matrixL());
    }

    void step(RandomGenerator& random) {
        Eigen::Matrix<double, 3, 2> noise;
        for (int row = 0; row < 3; ++row)
            noise.row(row) = normals(random).transpose();
        state_ = transition_ * state_ + factor_ * noise;
    }
    Eigen::Vector2d position() const { return state_.row(0).transpose(); }

  private:
    Eigen::Matrix3d transition_;
    Eigen::Matrix3d factor_;
    Eigen::Matrix<double, 3, 2> state_ = Eigen::Matrix<double, 3, 2>::Zero();
};

}  // namespace

SimulatedRecording simulate_recording(const StudyRun& run, std::uint64_t seed) {
    RandomGenerator random(seed);
    const double dt_s = 1.0 / run.rate_hz;
    const auto epochs = static_cast<std::size_t>(std::lround(run.length_s * run.rate_hz)) + 1;
    SimulatedRecording recording;
    recording.screened.facts.receiver = "primary";
    recording.screened.facts.vertical_measured = false;
    recording.screened.facts.nominal_interval_s = dt_s;
    RandomMotion motion(run.jerk_density, dt_s);
    const double decay = std::exp(-dt_s / run.noise.error_tau_s);
    Eigen::Vector2d error = run.noise.error_sigma_m * normals(random);
    for (std::size_t k = 0; k < epochs; ++k) {
        if (k > 0) {
            motion.step(random);
            error = decay * error +
                    run.noise.error_sigma_m * std::sqrt(1.0 - decay * decay) * normals(random);
        }
        const double time_s = static_cast<double>(k) * dt_s;
        const double along_m = logistic_run({}, time_s).distance_m / std::numbers::sqrt2;
        recording.truth.push_back(Eigen::Vector2d::Constant(1000.0 + along_m) + motion.position());
        const Eigen::Vector2d measured =
            recording.truth.back() + error + run.noise.white_m * normals(random);
        ScreenedEpoch& row = recording.screened.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time = {std::llround(time_s * 1e9)};
        row.east_m = measured.x();
        row.north_m = measured.y();
        row.sigma_east_m = row.sigma_north_m = run.noise.white_m;
        row.fix = FixKind::fixed;
        row.usable = true;
        row.arc = 1;
        if (k == 0) row.break_before = ArcBreak::start;
    }
    return recording;
}

}  // namespace runcert
