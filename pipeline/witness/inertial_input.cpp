#include "witness/inertial_input.h"

#include <cassert>
#include <cmath>

#include "schemas/observations/stated_covariance.h"
#include "witness/position_pairs.h"

namespace runcert {
namespace {

constexpr double standard_gravity_m_s2 = 9.80665;
constexpr double seconds_per_hour = 3600.0;

Eigen::Vector3d vector_of(const LeverArm& arm) {
    return {arm[0], arm[1], arm[2]};
}

ImuNoise noise_of(const ImuErrors& errors) {
    const double deg_h = radians_per_degree / seconds_per_hour;
    const double root_hour = std::sqrt(seconds_per_hour);
    const double mg = 1e-3 * standard_gravity_m_s2;
    return {.gyro_bias_rad_s = errors.gyro_bias_deg_h * deg_h,
            .angle_walk_rad_sqrt_s =
                errors.angle_random_walk_deg_sqrt_h * radians_per_degree / root_hour,
            .gyro_bias_walk_rad_s_sqrt_s = errors.gyro_bias_walk_deg_h_sqrt_h * deg_h / root_hour,
            .accelerometer_bias_m_s2 = errors.accelerometer_bias_mg * mg,
            .velocity_walk_m_s_sqrt_s = errors.velocity_random_walk_m_s_sqrt_h / root_hour,
            .accelerometer_bias_walk_m_s2_sqrt_s =
                errors.accelerometer_bias_walk_mg_sqrt_h * mg / root_hour};
}

/// A phone's, if nothing is stated.
ImuNoise noise_of(const std::optional<ImuGrade>& grade) {
    if (grade && grade->errors) return noise_of(*grade->errors);
    if (grade && grade->name == "tactical") return imu_noise(ImuClass::tactical);
    if (grade && grade->name == "mems") return imu_noise(ImuClass::mems);
    return imu_noise(ImuClass::consumer);
}

std::vector<ImuSample> samples_of(const ImuTable& imu) {
    std::vector<ImuSample> samples;
    samples.reserve(imu.rows.size());
    for (const ImuRow& row : imu.rows)
        samples.push_back({.time_s = row.time.seconds(),
                           .interval_s = row.interval_s,
                           .angle_rad = row.interval_s * Eigen::Vector3d(row.rate_forward_rad_s,
                                                                         row.rate_right_rad_s,
                                                                         row.rate_down_rad_s),
                           .velocity_m_s = row.interval_s * Eigen::Vector3d(row.force_forward_m_s2,
                                                                            row.force_right_m_s2,
                                                                            row.force_down_m_s2)});
    return samples;
}

/// What the noise fit multiplied the stated standard deviations by.
double scale_of(const AxesEstimation& axes) {
    return axes.noise.measurement_scale.value;
}

std::vector<PositionFix> fixes_of(const ScreenedTable& screened,
                                  const EstimationSummary& estimation) {
    const Eigen::Vector3d scale(
        scale_of(estimation.horizontal), scale_of(estimation.horizontal),
        scale_of(estimation.vertical ? *estimation.vertical : estimation.horizontal));
    std::vector<PositionFix> fixes;
    for (const ScreenedEpoch& row : screened.rows)
        if (row.usable && row.east_m && row.north_m && row.up_m && row.sigma_up_m)
            fixes.push_back({.time_s = row.time.seconds(),
                             .enu_m = {*row.east_m, *row.north_m, *row.up_m},
                             .covariance_m2 = scale.asDiagonal() * stated_covariance<3>(row) *
                                              scale.asDiagonal()});
    return fixes;
}

AntennaBaseline baseline_of(const ImuTable& imu, const ScreenedTable& screened,
                            const SecondAntenna& second) {
    const Eigen::Vector3d reference = vector_of(imu.reference_point.value_or(LeverArm{}));
    AntennaBaseline baseline{.body_m = reference - vector_of(second.arm) - vector_of(imu.antenna)};
    if (!screened.facts.vertical_measured || !second.screened.facts.vertical_measured)
        return baseline;
    for (const PositionPair& pair : position_pairs(screened, second.screened))
        baseline.fixes.push_back({.time_s = pair.time.seconds(),
                                  .enu_m = pair.difference,
                                  .covariance_m2 = pair.covariance});
    return baseline;
}

}  // namespace

const Receiver* second_on_craft(const Attempt& attempt) {
    const auto& receivers = attempt.receivers;
    if (receivers.size() < 2 || !has_imu(receivers[0]) || !receivers[1].lever_arm) return nullptr;
    return &receivers[1];
}

InertialInput inertial_input(const ImuTable& imu, const ScreenedTable& screened,
                             const TrajectoryTable& trajectory,
                             const std::optional<SecondAntenna>& second) {
    assert(screened.origin);
    InertialInput input{.samples = samples_of(imu),
                        .fixes = fixes_of(screened, trajectory.estimation),
                        .setup = {.origin = screened.origin->position,
                                  .noise = noise_of(imu.grade),
                                  .antenna_m = vector_of(imu.antenna)}};
    if (second) input.setup.baseline = baseline_of(imu, screened, *second);
    if (imu.reference_point) input.setup.reference_point_m = vector_of(*imu.reference_point);
    const NoiseSummary& noise = trajectory.estimation.horizontal.noise;
    if (noise.correlated_error_detected && noise.error_sigma_m && noise.error_tau_s) {
        PositionErrorModel& error = input.setup.position_error;
        error.vertical_m *= noise.error_sigma_m->value / error.horizontal_m;
        error.horizontal_m = noise.error_sigma_m->value;
        error.time_s = noise.error_tau_s->value;
    }
    return input;
}

}  // namespace runcert
