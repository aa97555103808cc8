#include "stages/smooth/attitude_table.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/figures.h"
#include "core/text.h"
#include "stages/smooth/imu_judgements.h"

namespace runcert {
namespace {

struct Doubted {
    InertialStanding standing;
    std::string reason;
};

/// A finding of the solution in a word and a sentence.
Doubted doubted_for(const InertialDoubt& doubt) {
    const std::string figure = significant_text(doubt.figure, 3);
    const std::string limit = significant_text(doubt.limit, 3);
    switch (doubt.finding) {
        case InertialFinding::innovations_large:
            return {InertialStanding::innovations_too_large,
                    fmt::format("The positions differ from what the IMU says by more than both "
                                "explain: the mean square of the normalised innovations is {}, at "
                                "most {} is accepted.",
                                figure, limit)};
        case InertialFinding::innovations_small:
            return {InertialStanding::innovations_too_small,
                    fmt::format("The positions differ from what the IMU says by less than chance: "
                                "the mean square of the normalised innovations is {}, at least {} "
                                "is accepted. Their stated uncertainties are too large.",
                                figure, limit)};
        case InertialFinding::heading_unobservable:
            return {InertialStanding::heading_unobservable,
                    fmt::format("The motion does not show the heading: its standard uncertainty is "
                                "{} degrees, at most {} is accepted, and the reference point lies "
                                "beside the antenna.",
                                significant_text(doubt.figure * degrees_per_radian, 3),
                                significant_text(doubt.limit * degrees_per_radian, 3))};
        case InertialFinding::vertical_arm_unobservable:
            return {InertialStanding::arm_unobservable,
                    "The craft hardly rolls or pitches, so that the motion does not show how high "
                    "the antenna is above the IMU. Measure it."};
        case InertialFinding::noise_large:
            return {InertialStanding::noise_too_large,
                    "No noise of an IMU of its class explains the positions. The IMU was not fixed "
                    "to the craft, belongs to another run, or the receiver filtered its "
                    "positions."};
        case InertialFinding::not_converged:
            return {InertialStanding::not_aligned,
                    "The attitude still turned when the solution was repeated: no start of it "
                    "leads to a solution."};
    }
    return {InertialStanding::not_aligned, ""};
}

/// What shakes the IMU, where that may be why its solution is refused. A craft on wheels at speed
/// has 1 to 2 m/s^2; an IMU's own noise some hundredths.
std::string shaken_by(const Shaking& shaking) {
    constexpr double of_an_engine_m_s2 = 0.5, of_vibration_m_s2 = 3.0, growing = 2.0;
    std::string text;
    if (shaking.standing_m_s2 > of_an_engine_m_s2)
        text += fmt::format(
            " While the craft stands, the specific force scatters by {:.1f} m/s^2 within a second: "
            "an engine that idles shakes the IMU.",
            shaking.standing_m_s2);
    if (shaking.fast_m_s2 > of_vibration_m_s2 && shaking.slow_m_s2 > 0.0 &&
        shaking.fast_m_s2 > growing * shaking.slow_m_s2)
        text += fmt::format(
            " At speed the specific force scatters by {:.1f} m/s^2 within a second, by {:.1f} "
            "below "
            "half of it: vibration that grows with speed shakes the IMU. Mount it on something "
            "that "
            "damps.",
            shaking.fast_m_s2, shaking.slow_m_s2);
    return text;
}

InertialStart start_of(StartMethod method) {
    switch (method) {
        case StartMethod::given:
        case StartMethod::course:
            return InertialStart::course;
        case StartMethod::earth_rotation:
            return InertialStart::standing;
        case StartMethod::search:
            return InertialStart::headings;
        case StartMethod::baseline:
            return InertialStart::antennas;
        case StartMethod::surface:
            return InertialStart::surface;
    }
    return InertialStart::course;
}

SurfaceStart surface_start_of(const StartAttitude& start) {
    const EulerAngles angles = euler_angles(start.enu_from_body);
    const Eigen::Matrix3d jacobian = euler_jacobian(start.enu_from_body);
    const Eigen::Vector3d sigma_deg =
        degrees_per_radian *
        (jacobian * start.covariance_rad2 * jacobian.transpose()).diagonal().cwiseSqrt();
    return {.roll_deg = angles.roll * degrees_per_radian,
            .pitch_deg = angles.pitch * degrees_per_radian,
            .heading_deg = angles.heading * degrees_per_radian,
            .sigma_roll_deg = sigma_deg.x(),
            .sigma_pitch_deg = sigma_deg.y(),
            .sigma_heading_deg = sigma_deg.z()};
}

InertialConsistency consistency_of(const InertialSolution& solution) {
    constexpr std::int64_t searched_headings = 12;
    InertialConsistency consistency{
        .start = start_of(solution.start),
        .starts = solution.start == StartMethod::search ? searched_headings : 1,
        .passes = solution.passes,
        .epochs = std::ssize(solution.epochs),
        .normalised_innovations = solution.consistency.nis,
        .autocorrelation = solution.consistency.lag_one_correlation,
        .beyond_share = solution.consistency.beyond_share};
    if (solution.start == StartMethod::surface)
        consistency.start_on_surface = surface_start_of(solution.start_attitude);
    if (!solution.consistency.consistent()) {
        const Doubted doubted = doubted_for(solution.consistency.doubts.front());
        consistency.standing = doubted.standing;
        consistency.reason = doubted.reason + shaken_by(solution.consistency.shaking);
    }
    return consistency;
}

/// A straight run determines a displacement whichever way the IMU points, but not where another
/// point of the craft is. No craft goes so far from where it heads.
void refuse_wrong_axes(AttitudeTable& attitude) {
    constexpr double most_deg = 30.0;
    const auto& remaining = attitude.mount.remaining;
    InertialConsistency& found = attitude.consistency;
    if (!remaining || found.standing != InertialStanding::consistent ||
        std::max(std::abs(remaining->pitch), std::abs(remaining->yaw)) <= most_deg)
        return;
    found.standing = InertialStanding::axes_wrong;
    found.reason = fmt::format(
        "Against course and level the axes of the IMU are turned by {:.0f} degrees in pitch and "
        "{:.0f} in yaw: axes or mount_deg of the attempt are wrong.",
        remaining->pitch, remaining->yaw);
}

void set_point(AttitudeEpoch& row, const PointMotion& point) {
    const Eigen::Vector3d position_sigma = point.position_covariance_m2.diagonal().cwiseSqrt();
    const Eigen::Vector3d velocity_sigma = point.velocity_covariance_m2_s2.diagonal().cwiseSqrt();
    row.reference_east_m = point.position_m.x();
    row.reference_north_m = point.position_m.y();
    row.reference_up_m = point.position_m.z();
    row.sigma_reference_east_m = position_sigma.x();
    row.sigma_reference_north_m = position_sigma.y();
    row.sigma_reference_up_m = position_sigma.z();
    row.reference_velocity_east_m_s = point.velocity_m_s.x();
    row.reference_velocity_north_m_s = point.velocity_m_s.y();
    row.reference_velocity_up_m_s = point.velocity_m_s.z();
    row.sigma_reference_velocity_east_m_s = velocity_sigma.x();
    row.sigma_reference_velocity_north_m_s = velocity_sigma.y();
    row.sigma_reference_velocity_up_m_s = velocity_sigma.z();
}

void set_attitude(AttitudeEpoch& row, const InertialEpoch& epoch, const Geodetic& origin) {
    row.roll_deg = epoch.attitude.roll * degrees_per_radian;
    row.pitch_deg = epoch.attitude.pitch * degrees_per_radian;
    row.heading_deg = epoch.attitude.heading * degrees_per_radian;
    row.sigma_roll_deg = epoch.attitude_sigma.roll * degrees_per_radian;
    row.sigma_pitch_deg = epoch.attitude_sigma.pitch * degrees_per_radian;
    row.sigma_heading_deg = epoch.attitude_sigma.heading * degrees_per_radian;
    row.rate_forward_deg_s = epoch.rate_rad_s.x() * degrees_per_radian;
    row.rate_right_deg_s = epoch.rate_rad_s.y() * degrees_per_radian;
    row.rate_down_deg_s = epoch.rate_rad_s.z() * degrees_per_radian;
    const Eigen::Quaterniond turned = quaternion_of(ecef_from_body(origin, epoch.enu_from_body));
    row.quaternion_w = turned.w();
    row.quaternion_x = turned.x();
    row.quaternion_y = turned.y();
    row.quaternion_z = turned.z();
}

void set_errors(AttitudeEpoch& row, const InertialEpoch& epoch) {
    row.gyro_bias_forward_deg_s = epoch.bias.gyro_rad_s.x() * degrees_per_radian;
    row.gyro_bias_right_deg_s = epoch.bias.gyro_rad_s.y() * degrees_per_radian;
    row.gyro_bias_down_deg_s = epoch.bias.gyro_rad_s.z() * degrees_per_radian;
    row.accelerometer_bias_forward_m_s2 = epoch.bias.accelerometer_m_s2.x();
    row.accelerometer_bias_right_m_s2 = epoch.bias.accelerometer_m_s2.y();
    row.accelerometer_bias_down_m_s2 = epoch.bias.accelerometer_m_s2.z();
    row.innovation_east = epoch.innovation.x();
    row.innovation_north = epoch.innovation.y();
    row.innovation_up = epoch.innovation.z();
}

/// Sets the rows whose positions took part; both are in the order of time.
void set_rows(const InertialSolution& solution, const Geodetic& origin, AttitudeTable& table) {
    auto row = table.rows.begin();
    for (const InertialEpoch& epoch : solution.epochs) {
        row = std::find_if(row, table.rows.end(), [&](const AttitudeEpoch& one) {
            return one.usable && one.time.seconds() == epoch.time_s;
        });
        if (row == table.rows.end()) return;
        set_attitude(*row, epoch, origin);
        set_point(*row, epoch.reference_point);
        set_errors(*row, epoch);
    }
}

/// The table before anything is solved.
AttitudeTable stated_table(const ImuTable& imu, const ScreenedTable& screened) {
    AttitudeTable attitude{
        .header = {},
        .facts = screened.facts,
        .origin = screened.origin,
        .grade = imu.grade,
        .time_offset = {.declared_s = imu.clock.offset_s, .used_s = imu.clock.offset_s},
        .antenna = {.declared = imu.antenna, .used = imu.antenna},
        .reference_point = imu.reference_point,
        .mount = {.declared = imu.mount},
        .rows = {}};
    for (const ScreenedEpoch& row : screened.rows)
        attitude.rows.push_back({.epoch = row.epoch, .time = row.time, .usable = row.usable});
    return attitude;
}

AttitudeTable unsolved(AttitudeTable attitude, std::string reason) {
    attitude.consistency.standing = InertialStanding::not_aligned;
    attitude.consistency.reason = std::move(reason);
    return attitude;
}

void set_estimates(const InertialSolution& solution, const Triangulation* surface,
                   AttitudeTable& attitude) {
    const double stated_s = attitude.time_offset.declared_s;
    if (solution.time_offset_s.sigma > 0.0) {
        // The estimator says how late the samples still are.
        attitude.time_offset.estimated_s = stated_s - solution.time_offset_s.value;
        attitude.time_offset.sigma_s = solution.time_offset_s.sigma;
        attitude.time_offset.used_s = *attitude.time_offset.estimated_s;
    }
    attitude.noise = likeliest_noise(solution.noise);
    judge_mount(solution, surface, attitude.mount);
    for (const BridgedStretch& bridged : solution.bridged)
        attitude.bridged.push_back({.from_s = bridged.from_s, .to_s = bridged.to_s});
    if (solution.time_offset_asked_by_innovations)
        attitude.notes.push_back(fmt::format(
            "The motion shows that {} s are to be added to the IMU's times; {} s are stated.",
            significant_text(attitude.time_offset.used_s, 3), significant_text(stated_s, 3)));
}

}  // namespace

AttitudeTable attitude_table(const ImuTable& imu, const ScreenedTable& screened,
                             const TrajectoryTable& trajectory,
                             const std::optional<SecondAntenna>& second,
                             const Triangulation* surface) {
    AttitudeTable attitude = stated_table(imu, screened);
    if (!screened.origin)
        return unsolved(std::move(attitude),
                        "Positions in a plane have no place on the Earth, by which gravity and the "
                        "Earth's rotation would be known. The attempt's origin states it.");
    const InertialInput input = inertial_input(imu, screened, trajectory, second, surface);
    if (const std::size_t within = positions_within(input.samples, input.fixes, input.setup);
        within < least_positions)
        return unsolved(std::move(attitude),
                        fmt::format("{} usable positions with heights lie within the IMU's "
                                    "samples, {} are needed.",
                                    within, least_positions));
    InertialSolution solution = smooth_inertial(input.samples, input.fixes, input.setup);
    if (auto again = solution_with_arm_shown(input, solution, attitude.antenna, attitude.notes))
        solution = *std::move(again);
    attitude.consistency = consistency_of(solution);
    set_estimates(solution, surface, attitude);
    refuse_wrong_axes(attitude);
    set_rows(solution, input.setup.origin, attitude);
    if (second) compare_headings(solution, input.setup, second->screened.facts.receiver, attitude);
    return attitude;
}

}  // namespace runcert
