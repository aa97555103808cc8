#include "witness/inertial_input.h"

#include <cassert>
#include <cmath>

#include "schemas/observations/stated_covariance.h"
#include "witness/position_pairs.h"
#include "witness/surface_input.h"

namespace runcert {
namespace {

constexpr double standard_gravity_m_s2 = 9.80665;
constexpr double seconds_per_hour = 3600.0;

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

ImuNoise with_likeliest(ImuNoise noise, const LikeliestNoise& found) {
    const double root_hour = std::sqrt(seconds_per_hour);
    noise.angle_walk_rad_sqrt_s =
        found.angle_random_walk_deg_sqrt_h * radians_per_degree / root_hour;
    noise.velocity_walk_m_s_sqrt_s = found.velocity_random_walk_m_s_sqrt_h / root_hour;
    noise.motion_sqrt_s = found.with_motion_sqrt_s;
    return noise;
}

/// The IMU's own motion, from that of the reference point.
ImuState state_of(const AttitudeEpoch& row, const Eigen::Vector3d& reference_point_m) {
    const Eigen::Vector3d rate_rad_s =
        radians_per_degree *
        Eigen::Vector3d(*row.rate_forward_deg_s, *row.rate_right_deg_s, *row.rate_down_deg_s);
    ImuState state;
    NavigationState& motion = state.motion;
    motion.enu_from_body = rotation_of({.roll = *row.roll_deg * radians_per_degree,
                                        .pitch = *row.pitch_deg * radians_per_degree,
                                        .heading = *row.heading_deg * radians_per_degree});
    motion.position_m =
        Eigen::Vector3d(*row.reference_east_m, *row.reference_north_m, *row.reference_up_m) -
        motion.enu_from_body * reference_point_m;
    motion.velocity_m_s =
        Eigen::Vector3d(*row.reference_velocity_east_m_s, *row.reference_velocity_north_m_s,
                        *row.reference_velocity_up_m_s) -
        motion.enu_from_body * rate_rad_s.cross(reference_point_m);
    state.bias.gyro_rad_s =
        radians_per_degree * Eigen::Vector3d(*row.gyro_bias_forward_deg_s,
                                             *row.gyro_bias_right_deg_s, *row.gyro_bias_down_deg_s);
    state.bias.accelerometer_m_s2 = {*row.accelerometer_bias_forward_m_s2,
                                     *row.accelerometer_bias_right_m_s2,
                                     *row.accelerometer_bias_down_m_s2};
    return state;
}

StartAttitude start_of(const SurfaceStart& start) {
    const Eigen::Matrix3d attitude =
        rotation_of({.roll = start.roll_deg * radians_per_degree,
                     .pitch = start.pitch_deg * radians_per_degree,
                     .heading = start.heading_deg * radians_per_degree});
    return {attitude, attitude_covariance(
                          attitude, {.roll = start.sigma_roll_deg * radians_per_degree,
                                     .pitch = start.sigma_pitch_deg * radians_per_degree,
                                     .heading = start.sigma_heading_deg * radians_per_degree})};
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
                                  const EstimationSummary& estimation,
                                  const Triangulation* surface) {
    const Eigen::Vector3d scale(
        scale_of(estimation.horizontal), scale_of(estimation.horizontal),
        scale_of(estimation.vertical ? *estimation.vertical : estimation.horizontal));
    std::vector<PositionFix> fixes;
    for (const ScreenedEpoch& row : screened.rows) {
        if (!row.usable || !row.east_m || !row.north_m || !row.up_m || !row.sigma_up_m) continue;
        PositionFix& fix = fixes.emplace_back(PositionFix{
            .time_s = row.time.seconds(),
            .enu_m = {*row.east_m, *row.north_m, *row.up_m},
            .covariance_m2 = scale.asDiagonal() * stated_covariance<3>(row) * scale.asDiagonal()});
        if (surface == nullptr) continue;
        const Eigen::Vector3d place = in_frame_of_origin(screened.origin, row.time, fix.enu_m);
        if (const auto below = surface->at(place.head<2>())) fix.ground_normal = below->normal;
    }
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

/// The class stated, or else that whose gyros have at most three times the bias of the figures
/// stated.
ImuClass class_of(const std::optional<ImuGrade>& grade) {
    constexpr double like = 3.0;
    if (!grade) return ImuClass::consumer;
    if (!grade->errors)
        return grade->name == "tactical" ? ImuClass::tactical
               : grade->name == "mems"   ? ImuClass::mems
                                         : ImuClass::consumer;
    for (const ImuClass one : {ImuClass::tactical, ImuClass::mems})
        if (noise_of(*grade->errors).gyro_bias_rad_s <= like * imu_noise(one).gyro_bias_rad_s)
            return one;
    return ImuClass::consumer;
}

/// Standard uncertainty of the arm to the antenna: as measured, and as the IMU's axes err.
double arm_sigma_m(const ImuTable& imu) {
    return std::hypot(imu.arm_sigma_m,
                      axes_error(class_of(imu.grade)) * vector_of(imu.antenna).norm());
}

}  // namespace

ImuNoise imu_noise(const std::optional<ImuGrade>& grade) {
    return grade && grade->errors ? noise_of(*grade->errors) : imu_noise(class_of(grade));
}

const Receiver* second_on_craft(const Attempt& attempt) {
    const auto& receivers = attempt.receivers;
    if (receivers.size() < 2 || !has_imu(receivers[0]) || !receivers[1].lever_arm) return nullptr;
    return &receivers[1];
}

InertialInput inertial_input(const ImuTable& imu, const ScreenedTable& screened,
                             const TrajectoryTable& trajectory,
                             const std::optional<SecondAntenna>& second,
                             const Triangulation* surface) {
    assert(screened.origin);
    InertialInput input{.samples = samples_of(imu),
                        .fixes = fixes_of(screened, trajectory.estimation, surface),
                        .setup = {.origin = screened.origin->position,
                                  .noise = imu_noise(imu.grade),
                                  .antenna_m = vector_of(imu.antenna),
                                  .antenna_sigma_m = arm_sigma_m(imu)}};
    input.setup.noise.motion_sqrt_s = least_motion(class_of(imu.grade));
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

double arm_shown_sigma_m(const EstimatedArm& arm) {
    double sigma_m = 0.0;
    for (std::size_t k = 0; k < arm.declared.size(); ++k)
        sigma_m =
            std::max({sigma_m, (*arm.sigma)[k], std::abs((*arm.estimated)[k] - arm.declared[k])});
    return sigma_m;
}

void take_solution(const AttitudeTable& attitude, InertialSetup& setup) {
    setup.noise = with_likeliest(setup.noise, attitude.noise);
    setup.estimate_time_offset = attitude.time_offset.estimated_s.has_value();
    const EstimatedArm& arm = attitude.antenna;
    if (arm.used != arm.declared) {
        setup.antenna_m = vector_of(arm.used);
        setup.antenna_sigma_m = arm_shown_sigma_m(arm);
    }
    SolvedBefore& before = setup.before.emplace();
    // The estimator says how late the samples still are.
    before.time_offset_s = attitude.time_offset.declared_s - attitude.time_offset.used_s;
    before.searched = attitude.consistency.start == InertialStart::headings;
    if (const auto& start = attitude.consistency.start_on_surface) setup.start = start_of(*start);
    for (const AttitudeEpoch& row : attitude.rows)
        if (row.roll_deg) before.states.push_back(state_of(row, setup.reference_point_m));
}

LikeliestNoise likeliest_noise(const ImuNoise& noise) {
    const double root_hour = std::sqrt(seconds_per_hour);
    return {.angle_random_walk_deg_sqrt_h =
                noise.angle_walk_rad_sqrt_s * root_hour * degrees_per_radian,
            .velocity_random_walk_m_s_sqrt_h = noise.velocity_walk_m_s_sqrt_s * root_hour,
            .with_motion_sqrt_s = noise.motion_sqrt_s};
}

}  // namespace runcert
