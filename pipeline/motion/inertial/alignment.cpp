#include "inertial/alignment.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/failure.h"
#include "inertial/antenna_baseline.h"
#include "inertial/surface_attitude.h"

namespace runcert {
namespace {

constexpr double rad(double deg) {
    return deg * radians_per_degree;
}

/// A craft that moves at all; one whose course is its heading.
constexpr double moving_speed_m_s = 0.5, least_course_speed_m_s = 5.0;
constexpr double least_stand_s = 5.0;
/// Standard deviations of a craft that moves, against the ground and its course: a sailing craft
/// heels and makes leeway. [FHB03] has 1, 1 and 1.5 degrees for a car.
constexpr double course_roll_rad = rad(9.0), surface_roll_rad = rad(10.0);
constexpr double course_pitch_rad = rad(4.0), course_heading_rad = rad(5.0);
/// By gravity and by the Earth's rotation, with room: the filter uses the same samples again.
constexpr double standing_tilt_rad = rad(2.0);
constexpr double standing_headings = 2.0;
constexpr double search_tilt_rad = rad(9.0), search_heading_rad = rad(20.0);
constexpr int searched_headings = 12;
constexpr double searched_s = 60.0;
/// Beyond the first of these a heading is of no use, beyond the other there is none.
constexpr double useful_heading_rad = rad(15.0), no_heading_rad = rad(100.0);
/// Of position and velocity at the start: so vague that the positions alone decide.
constexpr double vague_position_m = 10.0, vague_velocity_m_s = 10.0;

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

/// The first epoch at which the horizontal speed by positions is this or more.
std::optional<std::size_t> first_faster(std::span<const PositionFix> fixes, double speed_m_s) {
    for (std::size_t k = 0; k < fixes.size(); ++k)
        if (velocity_of_positions(fixes, k).head<2>().norm() >= speed_m_s) return k;
    return std::nullopt;
}

/// Rotation of the body from one time to another by the gyros: body axes at `to_s` into those at
/// `from_s`, the Earth's rotation neglected.
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

/// The horizontal plane's normal, upwards, at the origin.
Eigen::Vector3d up_of(const EarthFrame& earth) {
    return -earth.gravity_m_s2(Eigen::Vector3d::Zero());
}

/// About all axes across a direction, to one standard deviation.
Eigen::Matrix3d information_across(const Eigen::Vector3d& direction, double sigma_rad) {
    const Eigen::Vector3d unit = direction.normalized();
    return (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / (sigma_rad * sigma_rad);
}

Eigen::Vector3d rotation_between(const DirectionPair& pair, const Eigen::Matrix3d& enu_from_body) {
    return (enu_from_body * pair.body.normalized()).cross(pair.enu.normalized());
}

/// From the first position to a second before the craft moves, on the positions' scale.
struct Stretch {
    double from_s = 0.0;
    double to_s = 0.0;
};
std::optional<Stretch> standing_stretch(std::span<const PositionFix> fixes) {
    const std::size_t moving = first_faster(fixes, moving_speed_m_s).value_or(fixes.size() - 1);
    const Stretch stand{fixes[0].time_s, fixes[moving].time_s - 1.0};
    return stand.to_s - stand.from_s < least_stand_s ? std::nullopt : std::optional(stand);
}

/// Course and ground at an epoch in motion, along the body's axes at the first position. `turned`
/// takes the axes there to those at the first, to `carried_rad`.
void add_motion(std::vector<DirectionPair>& pairs, const SurfaceMotion& motion, double roll_rad,
                const Eigen::Matrix3d& turned, double carried_rad) {
    const auto ground = attitude_on_surface(motion, 0.0);
    if (!ground) return;
    const Eigen::Vector3d ahead = ground->col(0), right = ground->col(1), down = ground->col(2);
    pairs.push_back({turned.col(0), ahead,
                     information_about(down, std::hypot(course_heading_rad, carried_rad)) +
                         information_about(right, std::hypot(course_pitch_rad, carried_rad))});
    pairs.push_back(
        {turned.col(2), down, information_about(ahead, std::hypot(roll_rad, carried_rad))});
}

/// Whether a direction agrees with an attitude about the vertical, to three standard deviations.
bool agrees(const DirectionPair& pair, const StartAttitude& start) {
    const double seen = pair.information(2, 2);
    if (!(seen > 0.0)) return true;
    return std::abs(rotation_between(pair, start.enu_from_body).z()) <=
               3.0 * std::sqrt(1.0 / seen + start.covariance_rad2(2, 2)) &&
           (start.enu_from_body * pair.body).dot(pair.enu) > 0.0;
}

/// The directions known at the first position, and which of them tells the heading.
struct KnownDirections {
    std::vector<DirectionPair> pairs;
    StartMethod heading = StartMethod::search;

    /// Adds one that agrees with those before.
    void add(const DirectionPair& pair, StartMethod kind) {
        const auto others = attitude_by_directions(pairs);
        if (others && !agrees(pair, *others)) return;
        pairs.push_back(pair);
        if (!others || kind == StartMethod::baseline) heading = kind;
    }
};

KnownDirections known_directions(const InertialData& data, const InertialSetup& setup) {
    KnownDirections known;
    const double offset_s = setup.time_offset_s;
    const auto stand = standing_stretch(data.fixes);
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();
    double bias_sigma = data.noise.gyro_bias_rad_s;
    std::optional<StandingMeans> means;
    if (stand) {
        means = standing_means(data.samples, stand->from_s + offset_s, stand->to_s + offset_s,
                               data.earth, data.noise);
        bias = means->rate_rad_s;
        bias_sigma = std::hypot(means->rate_sigma_rad_s, data.earth.rotation_rad_s().norm());
        known.pairs.push_back(
            means->gravity(data.earth, std::hypot(standing_tilt_rad, means->tilt_sigma_rad)));
    }
    if (const auto fast = first_faster(data.fixes, least_course_speed_m_s)) {
        const double from_s = data.fixes[0].time_s, to_s = data.fixes[*fast].time_s;
        const Eigen::Vector3d v = velocity_of_positions(data.fixes, *fast);
        // Gravity levels a craft that stands better than the ground where it moves.
        const auto normal = stand ? std::nullopt : data.fixes[*fast].ground_normal;
        add_motion(known.pairs, {normal.value_or(level_normal(v)), v},
                   normal ? surface_roll_rad : course_roll_rad,
                   body_rotation(data.samples, from_s + offset_s, to_s + offset_s, bias),
                   std::hypot(bias_sigma * (to_s - from_s),
                              data.noise.angle_walk_rad_sqrt_s * std::sqrt(to_s - from_s)));
        known.heading = normal ? StartMethod::surface : StartMethod::course;
    }
    if (!means) return known;
    if (means->heading_sigma_rad < useful_heading_rad)
        known.add(means->rotation(data.earth, standing_headings * means->heading_sigma_rad),
                  StartMethod::earth_rotation);
    // Antennas that are not where they are stated to be show another heading.
    if (setup.baseline)
        if (const auto pair = direction_of(*setup.baseline, stand->from_s, stand->to_s,
                                           known.pairs.front(), setup.position_error))
            known.add(*pair, StartMethod::baseline);
    return known;
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
    const Eigen::Vector3d up = up_of(data.earth);
    std::optional<InertialPrior> best;
    double greatest = 0.0;
    for (int i = 0; i < searched_headings; ++i) {
        const double heading = 2.0 * std::numbers::pi * i / searched_headings;
        const std::array pairs{
            DirectionPair{force, up, information_across(up, search_tilt_rad)},
            DirectionPair{Eigen::Vector3d::UnitX(),
                          Eigen::Vector3d(std::sin(heading), std::cos(heading), 0.0),
                          information_about(up, search_heading_rad)}};
        const InertialPrior prior = prior_with(attitude_by_directions(pairs).value(), part, setup);
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
    const Eigen::Matrix3d information =
        information_across(up, search_tilt_rad) + information_about(up, search_heading_rad);
    return {prior_with({first, information.inverse()}, data, setup), StartMethod::search};
}

}  // namespace

Eigen::Matrix3d information_about(const Eigen::Vector3d& axis, double sigma_rad) {
    const Eigen::Vector3d unit = axis.normalized();
    return unit * unit.transpose() / (sigma_rad * sigma_rad);
}

std::optional<StartAttitude> attitude_by_directions(std::span<const DirectionPair> pairs) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), sum = Eigen::Matrix3d::Zero();
    for (const DirectionPair& pair : pairs) {
        information += pair.information;
        sum +=
            pair.information.trace() * pair.enu.normalized() * pair.body.normalized().transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information, Eigen::EigenvaluesOnly);
    if (!(axes.eigenvalues().minCoeff() * no_heading_rad * no_heading_rad > 1.0))
        return std::nullopt;
    const Eigen::LLT<Eigen::Matrix3d> factor(information);
    Eigen::Matrix3d attitude = nearest_rotation(sum);
    constexpr int most_steps = 20;
    constexpr double settled_rad = 1e-9;
    for (int step = 0; step < most_steps; ++step) {
        Eigen::Vector3d vector = Eigen::Vector3d::Zero();
        for (const DirectionPair& pair : pairs)
            vector += pair.information * rotation_between(pair, attitude);
        const Eigen::Vector3d turn = factor.solve(vector);
        attitude = rotation_about(turn) * attitude;
        if (turn.norm() < settled_rad) break;
    }
    return StartAttitude{nearest_rotation(attitude), factor.solve(Eigen::Matrix3d::Identity())};
}

DirectionPair StandingMeans::gravity(const EarthFrame& earth, double sigma_rad) const {
    const Eigen::Vector3d up = up_of(earth);
    return {force_m_s2, up, information_across(up, sigma_rad)};
}

DirectionPair StandingMeans::rotation(const EarthFrame& earth, double sigma_rad) const {
    const Eigen::Vector3d up = up_of(earth);
    const Eigen::Vector3d& rotation = earth.rotation_rad_s();
    // Gravity shows the tilt better: only what lies across it counts.
    return {rate_rad_s - rate_rad_s.dot(force_m_s2) / force_m_s2.squaredNorm() * force_m_s2,
            rotation - rotation.dot(up) / up.squaredNorm() * up, information_about(up, sigma_rad)};
}

StandingMeans standing_means(std::span<const ImuSample> samples, double from_s, double to_s,
                             const EarthFrame& earth, const ImuNoise& noise) {
    const MeanRates mean = mean_rates(samples, from_s, to_s, Body::stands);
    const double g = up_of(earth).norm();
    if (!(std::abs(mean.force_m_s2.norm() / g - 1.0) < 0.05))
        throw Failure("IMU",
                      fmt::format("the mean specific force is {:.4g} m/s^2 while the craft stands, "
                                  "gravity {:.4g}",
                                  mean.force_m_s2.norm(), g),
                      "Check the unit of the accelerometers");
    const double root_s = std::sqrt(mean.duration_s);
    const double rate_sigma = noise.angle_walk_rad_sqrt_s / root_s;
    const double across = std::max(earth.rotation_rad_s().head<2>().norm(), 1e-12);
    return {
        .rate_rad_s = mean.rate_rad_s,
        .force_m_s2 = mean.force_m_s2,
        .rate_sigma_rad_s = rate_sigma,
        .tilt_sigma_rad =
            std::hypot(noise.accelerometer_bias_m_s2, noise.velocity_walk_m_s_sqrt_s / root_s) / g,
        .heading_sigma_rad = std::hypot(noise.gyro_bias_rad_s, rate_sigma) / across};
}

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

FoundStart find_start(const InertialData& data, const InertialSetup& setup, bool search) {
    if (setup.start && !search) return {prior_with(*setup.start, data, setup), StartMethod::given};
    if (!search) {
        const KnownDirections known = known_directions(data, setup);
        if (const auto start = attitude_by_directions(known.pairs))
            return {prior_with(*start, data, setup), known.heading};
    }
    return search_start(data, setup);
}

}  // namespace runcert
