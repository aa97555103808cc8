#include "inertial/alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/failure.h"
#include "inertial/antenna_baseline.h"
#include "inertial/surface_attitude.h"

namespace runcert {
namespace {

constexpr double least_course_speed_m_s = 5.0;
constexpr double least_stand_s = 5.0;
/// Standard deviations of a craft that moves, against level and course.
constexpr double course_roll_deg = 9.0, course_pitch_deg = 4.0, course_heading_deg = 5.0;
/// The same against a surface and the course along it: a sailing craft heels.
constexpr double surface_roll_deg = 10.0, surface_pitch_deg = 4.0, surface_heading_deg = 5.0;
/// Of roll and pitch by gravity, with room: the filter uses the same samples again.
constexpr double standing_tilt_deg = 2.0;
constexpr double search_tilt_deg = 9.0, search_heading_deg = 20.0;
constexpr int searched_headings = 12;
constexpr double searched_s = 60.0;
/// An unknown heading.
constexpr double no_heading_rad = 100.0 * radians_per_degree;
/// Of position and velocity at the start: so vague that the positions alone decide.
constexpr double vague_position_m = 10.0, vague_velocity_m_s = 10.0;

constexpr double rad(double deg) {
    return deg * radians_per_degree;
}

constexpr double useful_heading_rad = rad(15.0);

struct MeanRates {
    Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d force_m_s2 = Eigen::Vector3d::Zero();
    double duration_s = 0.0;
};

enum class Body { stands, turns };

/// Mean rates over a stretch. The specific force of a body that turns is along its axes at the
/// beginning, by the gyros; one that stands on the Earth keeps its axes against gravity.
MeanRates mean_rates(std::span<const ImuSample> samples, double from_s, double to_s, Body body) {
    SampleReader reader(samples);
    reader.seek(from_s);
    MeanRates mean;
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
    while (const auto piece = reader.next(to_s)) {
        mean.rate_rad_s += piece->sample.angle_rad;
        mean.force_m_s2 += turned * piece->sample.velocity_m_s;
        mean.duration_s += piece->sample.interval_s;
        if (body == Body::turns) turned = turned * rotation_about(piece->sample.angle_rad);
    }
    mean.rate_rad_s /= mean.duration_s;
    mean.force_m_s2 /= mean.duration_s;
    return mean;
}

/// The attitude with this heading whose specific force points away from gravity.
Eigen::Matrix3d levelled(const Eigen::Vector3d& force_m_s2, double heading_rad) {
    const Eigen::Vector3d up = force_m_s2.normalized();
    // Roll and pitch of a body whose axes are forward, right and down.
    const double pitch = std::asin(std::clamp(up.x(), -1.0, 1.0));
    const double roll = std::atan2(-up.y(), -up.z());
    return rotation_of({.roll = roll, .pitch = pitch, .heading = heading_rad});
}

InertialPrior prior_with(const StartAttitude& start, const InertialData& data,
                         const InertialSetup& setup) {
    using namespace error_state;
    InertialPrior prior;
    InertialNominal& nominal = prior.nominal;
    nominal.state.enu_from_body = start.enu_from_body;
    nominal.antenna_m = setup.antenna_m;
    nominal.time_offset_s = setup.time_offset_s;
    nominal.state.velocity_m_s = velocity_of_positions(data.fixes, 0);
    nominal.state.position_m = data.fixes[0].enu_m - start.enu_from_body * setup.antenna_m;
    prior.covariance.setZero();
    prior.covariance.block<3, 3>(attitude, attitude) = start.covariance_rad2;
    const auto set = [&](int at, double sigma) {
        prior.covariance.diagonal().segment<3>(at).setConstant(sigma * sigma);
    };
    set(velocity, vague_velocity_m_s);
    set(position, vague_position_m);
    set(gyro_bias, setup.noise.gyro_bias_rad_s);
    set(accelerometer_bias, setup.noise.accelerometer_bias_m_s2);
    set(position_error, setup.position_error.horizontal_m);
    prior.covariance(position_error + 2, position_error + 2) =
        setup.position_error.vertical_m * setup.position_error.vertical_m;
    // What is not estimated is known, to far less than it could matter.
    set(lever_arm, setup.estimate_antenna ? setup.antenna_sigma_m : 1e-7);
    const double offset_sigma_s = setup.estimate_time_offset ? setup.time_offset_sigma_s : 1e-9;
    prior.covariance(time_offset, time_offset) = offset_sigma_s * offset_sigma_s;
    return prior;
}

/// From the first position to a second before the craft moves, by the IMU's times.
struct Stretch {
    double from_s = 0.0;
    double to_s = 0.0;
};
Stretch standing_stretch(const InertialData& data, const InertialSetup& setup) {
    const std::size_t moving =
        first_faster(data.fixes, moving_speed_m_s).value_or(data.fixes.size() - 1);
    return {data.fixes[0].time_s + setup.time_offset_s,
            data.fixes[moving].time_s + setup.time_offset_s - 1.0};
}

/// Where the craft stands at first: from the first position on, for so long.
std::optional<StandingAlignment> standing_at_first(const InertialData& data,
                                                   const InertialSetup& setup) {
    const Stretch stand = standing_stretch(data, setup);
    if (stand.to_s - stand.from_s < least_stand_s) return std::nullopt;
    return align_standing(data.samples, stand.from_s, stand.to_s, data.earth, data.noise);
}

/// The attitude of a craft that moves at an epoch, with standard deviations of its Euler angles.
struct MovingAttitude {
    std::size_t epoch = 0;
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    EulerAngles sigma = {};
};

/// An attitude carried back to the first position by the gyros. Where the craft stands at first,
/// its own level and its gyros' mean rate there.
StartAttitude carried_back(const MovingAttitude& there, const InertialData& data,
                           const InertialSetup& setup,
                           const std::optional<StandingAlignment>& standing) {
    const double from_s = data.fixes[0].time_s + setup.time_offset_s;
    const double to_s = data.fixes[there.epoch].time_s + setup.time_offset_s;
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();
    double bias_sigma = data.noise.gyro_bias_rad_s;
    if (standing) {
        bias = standing->rate_rad_s;
        bias_sigma = std::hypot(standing->rate_sigma_rad_s, data.earth.rotation_rad_s().norm());
    }
    Eigen::Matrix3d first =
        there.enu_from_body * body_rotation(data.samples, from_s, to_s, bias).transpose();
    const double carried = std::hypot(bias_sigma * (to_s - from_s),
                                      data.noise.angle_walk_rad_sqrt_s * std::sqrt(to_s - from_s));
    EulerAngles sigma{
        .roll = std::hypot(there.sigma.roll, carried),
        .pitch = std::hypot(there.sigma.pitch, carried),
        .heading = std::min(std::hypot(there.sigma.heading, carried), no_heading_rad)};
    if (standing) {
        EulerAngles level = euler_angles(standing->enu_from_body);
        level.heading = euler_angles(first).heading;
        first = rotation_of(level);
        sigma.roll = sigma.pitch = std::hypot(rad(standing_tilt_deg), standing->tilt_sigma_rad);
    }
    return {first, attitude_covariance(first, sigma)};
}

/// Level with the heading of the course at an epoch, carried back.
StartAttitude course_start(const InertialData& data, const InertialSetup& setup, std::size_t epoch,
                           const std::optional<StandingAlignment>& standing) {
    const Eigen::Vector3d v = velocity_of_positions(data.fixes, epoch);
    return carried_back(
        {.epoch = epoch,
         .enu_from_body = rotation_of(
             {.pitch = std::atan2(v.z(), v.head<2>().norm()), .heading = std::atan2(v.x(), v.y())}),
         .sigma = {rad(course_roll_deg), rad(course_pitch_deg), rad(course_heading_deg)}},
        data, setup, standing);
}

/// The attitude of a craft that stands, by gravity and the Earth's rotation.
StartAttitude earth_start(const StandingAlignment& standing) {
    const double tilt = std::hypot(rad(standing_tilt_deg), standing.tilt_sigma_rad);
    return {standing.enu_from_body,
            attitude_covariance(standing.enu_from_body,
                                {tilt, tilt, 2.0 * standing.heading_sigma_rad})};
}

/// Of a craft that stands at first, up by its accelerometers and the direction to a second antenna.
std::optional<StartAttitude> standing_baseline(const InertialData& data, const InertialSetup& setup,
                                               const StandingAlignment& standing) {
    if (!setup.baseline) return std::nullopt;
    const Stretch stand = standing_stretch(data, setup);
    const MeanRates mean = mean_rates(data.samples, stand.from_s, stand.to_s, Body::stands);
    return start_by_baseline(
        *setup.baseline, stand.from_s - setup.time_offset_s, stand.to_s - setup.time_offset_s,
        mean.force_m_s2, data.earth.gravity_m_s2(Eigen::Vector3d::Zero()),
        std::hypot(rad(standing_tilt_deg), standing.tilt_sigma_rad), setup.position_error);
}

double heading_sigma(const StartAttitude& start) {
    const Eigen::Vector3d row = euler_jacobian(start.enu_from_body).row(2);
    return std::sqrt(row.dot(start.covariance_rad2 * row));
}

bool headings_agree(const StartAttitude& one, const StartAttitude& other) {
    const double difference = std::remainder(
        euler_angles(one.enu_from_body).heading - euler_angles(other.enu_from_body).heading,
        2.0 * std::numbers::pi);
    return std::abs(difference) <= 3.0 * std::hypot(heading_sigma(one), heading_sigma(other));
}

}  // namespace

Eigen::Vector3d velocity_of_positions(std::span<const PositionFix> fixes, std::size_t epoch) {
    constexpr double half_s = 1.0;
    std::size_t first = epoch, last = epoch;
    while (first > 0 && fixes[epoch].time_s - fixes[first - 1].time_s <= half_s)
        --first;
    while (last + 1 < fixes.size() && fixes[last + 1].time_s - fixes[epoch].time_s <= half_s)
        ++last;
    if (first == last) {
        if (last + 1 < fixes.size())
            ++last;
        else if (first > 0)
            --first;
    }
    double mean_s = 0.0;
    for (std::size_t k = first; k <= last; ++k)
        mean_s += fixes[k].time_s;
    mean_s /= static_cast<double>(last - first + 1);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
        const double t = fixes[k].time_s - mean_s;
        sum += t * fixes[k].enu_m;
        squares += t * t;
    }
    return squares > 0.0 ? Eigen::Vector3d(sum / squares) : Eigen::Vector3d::Zero();
}

std::optional<std::size_t> first_faster(std::span<const PositionFix> fixes, double speed_m_s) {
    for (std::size_t k = 0; k < fixes.size(); ++k)
        if (velocity_of_positions(fixes, k).head<2>().norm() >= speed_m_s) return k;
    return std::nullopt;
}

Eigen::Matrix3d body_rotation(std::span<const ImuSample> samples, double from_s, double to_s,
                              const Eigen::Vector3d& gyro_bias_rad_s) {
    SampleReader reader(samples);
    reader.seek(from_s);
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
    while (const auto piece = reader.next(to_s))
        turned = turned * rotation_about(piece->sample.angle_rad -
                                         piece->sample.interval_s * gyro_bias_rad_s);
    return nearest_rotation(turned);
}

StandingAlignment align_standing(std::span<const ImuSample> samples, double from_s, double to_s,
                                 const EarthFrame& earth, const ImuNoise& noise) {
    const MeanRates mean = mean_rates(samples, from_s, to_s, Body::stands);
    const Eigen::Vector3d up = -earth.gravity_m_s2(Eigen::Vector3d::Zero());
    const double g = up.norm();
    if (!(std::abs(mean.force_m_s2.norm() / g - 1.0) < 0.05))
        throw Failure("IMU",
                      fmt::format("the mean specific force is {:.4g} m/s^2 while the craft stands, "
                                  "gravity {:.4g}",
                                  mean.force_m_s2.norm(), g),
                      "Check the unit of the accelerometers");
    const double root_s = std::sqrt(mean.duration_s);
    const Eigen::Vector3d& rotation = earth.rotation_rad_s();
    const double across = rotation.head<2>().norm();
    StandingAlignment alignment;
    alignment.tilt_sigma_rad =
        std::hypot(noise.accelerometer_bias_m_s2, noise.velocity_walk_m_s_sqrt_s / root_s) / g;
    alignment.rate_rad_s = mean.rate_rad_s;
    alignment.rate_sigma_rad_s = noise.angle_walk_rad_sqrt_s / root_s;
    alignment.heading_sigma_rad =
        std::hypot(noise.gyro_bias_rad_s, alignment.rate_sigma_rad_s) / std::max(across, 1e-12);
    if (alignment.heading_sigma_rad < 1.0) {
        const auto pair = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
            return VectorPair{a.normalized(), a.cross(b).normalized()};
        };
        alignment.enu_from_body = rotation_of_two_vectors(pair(mean.force_m_s2, mean.rate_rad_s),
                                                          pair(up, rotation), VectorTolerance{});
    } else {
        alignment.enu_from_body = levelled(mean.force_m_s2, 0.0);
    }
    return alignment;
}

std::optional<FoundStart> find_start(const InertialData& data, const InertialSetup& setup) {
    const auto found = [&](const StartAttitude& start, StartMethod kind) {
        return FoundStart{prior_with(start, data, setup), kind};
    };
    if (setup.start) return found(*setup.start, StartMethod::given);
    const auto standing = standing_at_first(data, setup);
    std::optional<StartAttitude> course;
    if (const auto fast = first_faster(data.fixes, least_course_speed_m_s))
        course = course_start(data, setup, *fast, standing);
    // Antennas that are not where they are stated to be show another heading.
    if (standing)
        if (const auto start = standing_baseline(data, setup, *standing);
            start && (!course || headings_agree(*start, *course)))
            return found(*start, StartMethod::baseline);
    if (course) return found(*course, StartMethod::course);
    if (standing && standing->heading_sigma_rad < useful_heading_rad)
        return found(earth_start(*standing), StartMethod::earth_rotation);
    return std::nullopt;
}

std::optional<FoundStart> surface_start(const InertialData& data, const InertialSetup& setup) {
    if (setup.start || standing_at_first(data, setup)) return std::nullopt;
    for (std::size_t k = 0; k < data.fixes.size(); ++k) {
        if (!data.fixes[k].ground_normal) continue;
        const auto there = attitude_on_surface(
            {*data.fixes[k].ground_normal, velocity_of_positions(data.fixes, k)},
            {.least_speed_m_s = least_course_speed_m_s});
        if (!there) continue;
        const StartAttitude first = carried_back(
            {.epoch = k,
             .enu_from_body = *there,
             .sigma = {rad(surface_roll_deg), rad(surface_pitch_deg), rad(surface_heading_deg)}},
            data, setup, std::nullopt);
        return FoundStart{prior_with(first, data, setup), StartMethod::surface};
    }
    return std::nullopt;
}

FoundStart search_start(const InertialData& data, const InertialSetup& setup) {
    const std::size_t begin = first_faster(data.fixes, moving_speed_m_s).value_or(0);
    InertialData part = data;
    part.fixes.assign(data.fixes.begin() + static_cast<std::ptrdiff_t>(begin), data.fixes.end());
    const auto end = std::ranges::upper_bound(part.fixes, part.fixes[0].time_s + searched_s, {},
                                              &PositionFix::time_s);
    part.fixes.erase(end, part.fixes.end());
    if (part.fixes.size() < 2) part = data;
    const double from_s = part.fixes[0].time_s + setup.time_offset_s;
    const double to_s = std::min(from_s + 4.0, part.fixes.back().time_s + setup.time_offset_s);
    const Eigen::Vector3d force = mean_rates(data.samples, from_s, to_s, Body::turns).force_m_s2;
    const EulerAngles sigma{rad(search_tilt_deg), rad(search_tilt_deg), rad(search_heading_deg)};
    std::optional<InertialPrior> best;
    double greatest = 0.0;
    for (int i = 0; i < searched_headings; ++i) {
        const Eigen::Matrix3d there =
            levelled(force, 2.0 * std::numbers::pi * i / searched_headings);
        const InertialPrior prior =
            prior_with({there, attitude_covariance(there, sigma)}, part, setup);
        const double likelihood = log_likelihood(part, prior, part.fixes.size());
        if (best && !(likelihood > greatest)) continue;
        best = prior;
        greatest = likelihood;
    }
    auto pass = filter_forwards(part, *best, {}, part.fixes.size());
    smooth_backwards(pass, part);
    const InertialNominal found = pass.solution(0);
    const Eigen::Matrix3d first =
        found.state.enu_from_body * body_rotation(data.samples,
                                                  data.fixes[0].time_s + setup.time_offset_s,
                                                  from_s, found.bias.gyro_rad_s)
                                        .transpose();
    return {prior_with({first, attitude_covariance(first, sigma)}, data, setup),
            StartMethod::search};
}

}  // namespace runcert
