#include <Eigen/LU>

#include "reports/compare/methods.h"

namespace runcert {
namespace {

/// What was measured of the velocity between two epochs.
std::optional<MeasuredVelocity> velocity_between(const std::optional<MeasuredVelocity>& before,
                                                 const std::optional<MeasuredVelocity>& after) {
    if (!before) return after;
    if (!after) return before;
    return MeasuredVelocity{
        .velocity_m_s = 0.5 * (before->velocity_m_s + after->velocity_m_s),
        .covariance_m2_s2 = 0.5 * (before->covariance_m2_s2 + after->covariance_m2_s2)};
}

void take_in(EnhancedKalmanState& state, const PositionMeasurement<3>& measured) {
    const Eigen::Matrix3d gain =
        state.covariance_m2 * (state.covariance_m2 + measured.covariance).inverse();
    const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain;
    state.position_m += gain * (measured.position - state.position_m);
    // Joseph form: symmetric and positive whatever the rounding of the gain.
    state.covariance_m2 = keep * state.covariance_m2 * keep.transpose() +
                          gain * measured.covariance * gain.transpose();
}

}  // namespace

std::vector<std::optional<EnhancedKalmanState>> filter_enhanced_kalman(
    std::span<const ArcEpoch<3>> arc, std::span<const std::optional<MeasuredVelocity>> velocities) {
    std::vector<std::optional<EnhancedKalmanState>> states;
    std::optional<EnhancedKalmanState> state;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto& measured = arc[k].measurement;
        const std::optional<MeasuredVelocity> input =
            state ? velocity_between(velocities[k - 1], velocities[k]) : std::nullopt;
        if (input) {
            const double dt_s = arc[k].time_s - arc[k - 1].time_s;
            const Eigen::Vector3d before_m = state->position_m;
            state->position_m += input->velocity_m_s * dt_s;
            state->covariance_m2 += input->covariance_m2_s2 * dt_s * dt_s;
            if (measured) take_in(*state, *measured);
            state->velocity_m_s = (state->position_m - before_m) / dt_s;
        } else {
            state.reset();
            if (measured)
                state = EnhancedKalmanState{.position_m = measured->position,
                                            .covariance_m2 = measured->covariance};
        }
        states.push_back(state);
    }
    return states;
}

}  // namespace runcert
