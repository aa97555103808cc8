#include "simulated_arc.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "motion/motion_model.h"
#include "simulation/simulate.h"

namespace runcert {
namespace {

Eigen::Vector2d normals(RandomGenerator& random) {
    const double east = random.normal();
    return {east, random.normal()};
}

using AxisStates = Eigen::Matrix<double, 3, 2>;  // position, velocity, acceleration

/// Random motion of white-noise jerk, both axes, from rest at the origin.
class RandomMotion {
  public:
    RandomMotion(double jerk_density, double return_time_s, double dt_s)
        : rate_(1.0 / return_time_s), per_jerk_(dt_s * dt_s * dt_s / 6.0, dt_s * dt_s / 2.0, dt_s) {
        EstimationModel model;
        model.motion.jerk_density = 1.0;
        const AxisStep step = axis_step(model, dt_s);
        transition_ = step.transition;
        factor_ = jerk_density * Eigen::Matrix3d(step.process_noise.llt().matrixL());
    }

    void step(RandomGenerator& random) {
        AxisStates noise;
        for (int row = 0; row < 3; ++row)
            noise.row(row) = normals(random).transpose();
        // (d/dt + rate)^3 position = white noise.
        const Eigen::RowVector2d back =
            rate_ * (rate_ * (rate_ * state_.row(0) + 3.0 * state_.row(1)) + 3.0 * state_.row(2));
        state_ = transition_ * state_ - per_jerk_ * back + factor_ * noise;
    }
    const AxisStates& state() const { return state_; }

  private:
    double rate_;
    Eigen::Vector3d per_jerk_;  ///< what a steady jerk of 1 m/s^3 adds to the state in a step
    Eigen::Matrix3d transition_;
    Eigen::Matrix3d factor_;
    AxisStates state_ = AxisStates::Zero();
};

/// Distance, speed and acceleration along the run at a time.
Eigen::Vector3d run_at(const StudyRun& run, double time_s) {
    if (run.script) {
        const LineState state = run.script->at(time_s);
        return {state.distance_m, state.speed_m_s, state.acceleration_m_s2};
    }
    constexpr double leg_s = 45.0;
    const auto forth = [](double at_s) -> Eigen::Vector3d {
        const RunState state = logistic_run({}, at_s);
        return {state.distance_m, state.speed_m_s, state.acceleration_m_s2};
    };
    if (!run.shuttle) return forth(time_s);
    // Backwards in time is braking. At the turns the speed of 0.01 m/s changes its sign: a
    // twentieth of what a test finds there.
    const auto forth_and_halt = [&](double at_s) -> Eigen::Vector3d {
        if (at_s <= leg_s) return forth(at_s);
        const Eigen::Vector3d mirrored = forth(2.0 * leg_s - at_s);
        return {2.0 * forth(leg_s)(0) - mirrored(0), mirrored(1), -mirrored(2)};
    };
    const double phase_s = std::fmod(time_s, 4.0 * leg_s);
    if (phase_s <= 2.0 * leg_s) return forth_and_halt(phase_s);
    return Eigen::Vector3d(2.0 * forth(leg_s)(0), 0.0, 0.0) - forth_and_halt(phase_s - 2.0 * leg_s);
}

}  // namespace

SimulatedRecording simulate_recording(const StudyRun& run, std::uint64_t seed) {
    RandomGenerator random(seed);
    const double dt_s = 1.0 / run.rate_hz;
    const auto epochs = static_cast<std::size_t>(std::lround(run.length_s * run.rate_hz)) + 1;
    SimulatedRecording recording;
    recording.screened.facts.receiver = "primary";
    recording.screened.facts.vertical_measured = false;
    recording.screened.facts.nominal_interval_s = dt_s;
    RandomMotion motion(run.jerk_density, run.return_time_s, dt_s);
    const double decay = std::exp(-dt_s / run.noise.error_tau_s);
    const auto error_of_one = [&]() -> Eigen::Vector2d {
        const Eigen::Vector2d both = normals(random);
        if (!run.noise.error_along_only) return both;
        return Eigen::Vector2d::Constant(both.x() / std::numbers::sqrt2);
    };
    Eigen::Vector2d error = run.noise.error_sigma_m * error_of_one();
    for (std::size_t k = 0; k < epochs; ++k) {
        if (k > 0) {
            motion.step(random);
            error = decay * error +
                    run.noise.error_sigma_m * std::sqrt(1.0 - decay * decay) * error_of_one();
        }
        const double time_s = static_cast<double>(k) * dt_s;
        const Eigen::Vector3d along = run_at(run, time_s) / std::numbers::sqrt2;
        const AxisStates state = along.replicate<1, 2>() + motion.state();
        recording.truth.push_back(Eigen::Vector2d::Constant(1000.0) + state.row(0).transpose());
        recording.velocity.push_back(state.row(1).transpose());
        recording.acceleration.push_back(state.row(2).transpose());
        const Eigen::Vector2d measured =
            recording.truth.back() + error + run.noise.white_m * normals(random);
        ScreenedEpoch& row = recording.screened.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time = {std::llround(time_s * 1e9)};
        row.east_m = measured.x();
        row.north_m = measured.y();
        row.sigma_east_m = row.sigma_north_m = run.noise.white_m;
        row.fix = run.noise.fix;
        row.usable = true;
        row.arc = 1;
        if (k == 0) row.break_before = ArcBreak::start;
    }
    return recording;
}

}  // namespace runcert
