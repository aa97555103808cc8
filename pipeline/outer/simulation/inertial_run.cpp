#include "simulation/inertial_run.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "simulation/craft_motion.h"

namespace runcert {
namespace {

/// The sample that leads from one state to the velocity and attitude at the next tick.
ImuSample sample_between(const NavigationState& from, const CraftState& to, double time_s,
                         const EarthFrame& earth) {
    const Eigen::Vector3d& w = earth.rotation_rad_s();
    const Eigen::Vector3d turned = rotation_vector(from.enu_from_body.transpose() *
                                                   rotation_about(tick_s * w) * to.enu_from_body);
    const Eigen::Vector3d gravity =
        earth.gravity_m_s2(from.position_m + 0.5 * tick_s * from.velocity_m_s);
    // v+ = v + s - 2 dt w x (v + s / 2), where s is specific force and gravity over the tick.
    const Eigen::Matrix3d gain = Eigen::Matrix3d::Identity() - tick_s * cross_matrix(w);
    const Eigen::Vector3d gained = gain.inverse() * (to.velocity_m_s - from.velocity_m_s +
                                                     2.0 * tick_s * w.cross(from.velocity_m_s));
    const Eigen::Vector3d pushed = from.enu_from_body.transpose() *
                                   (rotation_about(0.5 * tick_s * w) * (gained - tick_s * gravity));
    const Eigen::Matrix3d sculling = Eigen::Matrix3d::Identity() + 0.5 * cross_matrix(turned);
    return {.time_s = time_s,
            .interval_s = tick_s,
            .angle_rad = turned,
            .velocity_m_s = sculling.inverse() * pushed};
}

Eigen::Vector3d draw(RandomGenerator& random) {
    Eigen::Vector3d deviates;
    for (double& deviate : deviates)
        deviate = random.normal();
    return deviates;
}

/// The errors of an IMU, sample by sample.
class ImuErrorSequence {
  public:
    ImuErrorSequence(const InertialRunSpec& spec, RandomGenerator& random)
        : noise_(spec.noise), random_(random) {
        const double size = spec.with_biases ? 1.0 : 0.0;
        bias_.gyro_rad_s = size * noise_.gyro_bias_rad_s * draw(random_);
        bias_.accelerometer_m_s2 = size * noise_.accelerometer_bias_m_s2 * draw(random_);
        for (Eigen::Matrix3d* scale : {&gyro_scale_, &accelerometer_scale_})
            for (int axis = 0; axis < 3; ++axis)
                scale->col(axis) = Eigen::Vector3d::Unit(axis) + spec.scale_sigma * draw(random_);
    }

    const ImuBias& bias() const { return bias_; }

    void add(ImuSample& sample, double rate_rad_s, double acceleration_m_s2) {
        const double root_s = std::sqrt(sample.interval_s);
        const double angle =
            std::hypot(noise_.angle_walk_rad_sqrt_s, noise_.motion_sqrt_s * rate_rad_s);
        const double velocity =
            std::hypot(noise_.velocity_walk_m_s_sqrt_s, noise_.motion_sqrt_s * acceleration_m_s2);
        sample.angle_rad = (gyro_scale_ * sample.angle_rad).eval();
        sample.velocity_m_s = (accelerometer_scale_ * sample.velocity_m_s).eval();
        sample.angle_rad += sample.interval_s * bias_.gyro_rad_s + root_s * angle * draw(random_);
        sample.velocity_m_s +=
            sample.interval_s * bias_.accelerometer_m_s2 + root_s * velocity * draw(random_);
        bias_.gyro_rad_s += root_s * noise_.gyro_bias_walk_rad_s_sqrt_s * draw(random_);
        bias_.accelerometer_m_s2 +=
            root_s * noise_.accelerometer_bias_walk_m_s2_sqrt_s * draw(random_);
    }

  private:
    ImuNoise noise_;
    RandomGenerator& random_;
    ImuBias bias_;
    Eigen::Matrix3d gyro_scale_, accelerometer_scale_;
};

void require_possible(const InertialRunSpec& spec) {
    const auto divides = [](int hz) { return hz > 0 && ticks_hz % hz == 0; };
    if (!(spec.duration_s > 0.0) || !(spec.stand_s >= 0.0) || !divides(spec.imu_hz) ||
        !divides(spec.position_hz))
        throw Failure("simulation", "a duration is not positive, or a rate does not divide 400 Hz",
                      "Give rates that divide 400 Hz");
    const double offset_ticks = spec.time_offset_s * ticks_hz;
    if (!(std::abs(offset_ticks - std::round(offset_ticks)) < 1e-6))
        throw Failure("simulation", "the time offset is not a whole number of steps of 2.5 ms",
                      "Give a multiple of 0.0025 s");
    if (!(spec.white_horizontal_m >= 0.0) || !(spec.white_vertical_m >= 0.0) ||
        !(spec.position_error.horizontal_m >= 0.0) || !(spec.position_error.vertical_m >= 0.0) ||
        !(spec.position_error.time_s > 0.0))
        throw Failure("simulation", "a standard deviation is negative or a time not positive",
                      "Give standard deviations of 0 or more");
}

/// The errors of positions, one after the other.
class FixErrors {
  public:
    FixErrors(const InertialRunSpec& spec, RandomGenerator& random)
        : random_(random),
          white_(spec.white_horizontal_m, spec.white_horizontal_m, spec.white_vertical_m),
          slow_(spec.position_error.horizontal_m, spec.position_error.horizontal_m,
                spec.position_error.vertical_m),
          state_(draw(random_)) {
        const double steps = 1.0 / spec.position_hz / spec.position_error.time_s;
        phi_ = std::exp(-steps);
        fresh_ = std::sqrt(-std::expm1(-2.0 * steps));
    }

    Eigen::Vector3d next() {
        const Eigen::Vector3d error =
            white_.cwiseProduct(draw(random_)) + slow_.cwiseProduct(state_);
        state_ = phi_ * state_ + fresh_ * draw(random_);
        return error;
    }

  private:
    RandomGenerator& random_;
    Eigen::Vector3d white_, slow_, state_;
    double phi_ = 0.0, fresh_ = 0.0;
};

/// Where a point of the craft is at every tick.
class PointTrack {
  public:
    explicit PointTrack(const Eigen::Vector3d& arm_m) : arm_m_(arm_m) {}

    void add(const NavigationState& state) {
        places_m_.push_back(state.position_m + state.enu_from_body * arm_m_);
    }
    const Eigen::Vector3d& position_m(std::size_t tick) const { return places_m_[tick]; }
    /// By differences over two ticks: with a swing of 1 m and 1 Hz to 0.3 mm/s.
    Eigen::Vector3d velocity_m_s(std::size_t tick) const {
        const auto& [before, at, after] = around(tick);
        if (tick == 0) return (4.0 * at - 3.0 * before - after) / (2.0 * tick_s);
        return (after - before) / (2.0 * tick_s);
    }
    Eigen::Vector3d acceleration_m_s2(std::size_t tick) const {
        const auto& [before, at, after] = around(tick);
        return (after - 2.0 * at + before) / (tick_s * tick_s);
    }

  private:
    std::array<Eigen::Vector3d, 3> around(std::size_t tick) const {
        const std::size_t middle = std::max<std::size_t>(tick, 1);
        return {places_m_[middle - 1], places_m_[middle], places_m_[middle + 1]};
    }

    Eigen::Vector3d arm_m_;
    std::vector<Eigen::Vector3d> places_m_;
};

void add_points(const PointTrack& antenna, const PointTrack& reference_point, std::size_t tick,
                InertialTruth& truth) {
    truth.antenna_m = antenna.position_m(tick);
    truth.antenna_velocity_m_s = antenna.velocity_m_s(tick);
    truth.antenna_acceleration_m_s2 = antenna.acceleration_m_s2(tick);
    truth.reference_point_m = reference_point.position_m(tick);
    truth.reference_velocity_m_s = reference_point.velocity_m_s(tick);
}

/// Positions of an antenna with their errors.
std::vector<PositionFix> fixes_of(const InertialRunSpec& spec, std::uint64_t seed,
                                  const std::vector<InertialTruth>& truth,
                                  const Eigen::Vector3d& antenna_m) {
    RandomGenerator draws(seed);
    FixErrors errors(spec, draws);
    const Eigen::Vector3d sigma(spec.white_horizontal_m, spec.white_horizontal_m,
                                spec.white_vertical_m);
    std::vector<PositionFix> fixes;
    for (const InertialTruth& epoch : truth)
        fixes.push_back(
            {.time_s = epoch.time_s,
             .enu_m = epoch.imu.position_m + epoch.imu.enu_from_body * antenna_m + errors.next(),
             .covariance_m2 = sigma.cwiseProduct(sigma).asDiagonal().toDenseMatrix()});
    return fixes;
}

}  // namespace

InertialRun simulate_inertial(const InertialRunSpec& spec) {
    require_possible(spec);
    const EarthFrame earth(spec.origin);
    // One sequence for each kind of draw, so that a size changes no other draw.
    RandomGenerator shapes(spec.seed), imu_draws(spec.seed + 1'000'003);
    CraftMotion craft(spec, shapes);
    ImuErrorSequence imu_errors(spec, imu_draws);
    const auto ticks =
        static_cast<std::int64_t>(std::floor((spec.stand_s + spec.duration_s) * ticks_hz + 1e-6));
    const std::int64_t per_sample = ticks_hz / spec.imu_hz;
    const std::int64_t per_fix = ticks_hz / spec.position_hz;
    const std::int64_t late = std::llround(spec.time_offset_s * ticks_hz);
    InertialRun run;
    CraftState now = craft.at(0);
    NavigationState state{.enu_from_body = now.enu_from_body, .velocity_m_s = now.velocity_m_s};
    if (spec.run)
        state.position_m = {spec.run->start.east_m, spec.run->start.north_m, spec.run->start.up_m};
    PointTrack antenna(spec.antenna_m), reference_point(spec.reference_point_m);
    std::vector<std::size_t> epochs;
    ImuSample sum;
    Eigen::Vector3d begin_velocity_m_s = state.velocity_m_s;
    for (std::int64_t tick = 0; tick <= ticks; ++tick) {
        const CraftState next = craft.at(tick + 1);
        const double end_s = static_cast<double>(tick + 1) * tick_s;
        const ImuSample piece = sample_between(state, next, end_s, earth);
        antenna.add(state);
        reference_point.add(state);
        if ((tick - late) % per_fix == 0 && tick >= late) {
            epochs.push_back(static_cast<std::size_t>(tick));
            run.truth.push_back({.time_s = static_cast<double>(tick - late) * tick_s,
                                 .imu = state,
                                 .bias = imu_errors.bias(),
                                 .ground_normal = now.ground_normal});
        }
        state = strapdown_step(state, piece, {}, earth).state;
        now = next;
        sum.angle_rad += piece.angle_rad;
        sum.velocity_m_s += piece.velocity_m_s;
        if ((tick + 1) % per_sample != 0) continue;
        sum.time_s = end_s;
        sum.interval_s = static_cast<double>(per_sample) * tick_s;
        imu_errors.add(sum, sum.angle_rad.norm() / sum.interval_s,
                       (state.velocity_m_s - begin_velocity_m_s).norm() / sum.interval_s);
        run.samples.push_back(sum);
        sum = {};
        begin_velocity_m_s = state.velocity_m_s;
    }
    antenna.add(state);
    reference_point.add(state);
    for (std::size_t i = 0; i < epochs.size(); ++i)
        add_points(antenna, reference_point, epochs[i], run.truth[i]);
    run.fixes = fixes_of(spec, spec.seed + 2'000'003, run.truth, spec.antenna_m);
    if (spec.second_antenna_m)
        run.second_fixes = fixes_of(spec, spec.seed + 3'000'003, run.truth, *spec.second_antenna_m);
    return run;
}

InertialSetup setup_of(const InertialRunSpec& spec) {
    InertialSetup setup;
    setup.origin = spec.origin;
    setup.noise = spec.noise;
    setup.antenna_m = spec.antenna_m;
    setup.reference_point_m = spec.reference_point_m;
    setup.antenna_sigma_m = 0.0;
    return setup;
}

}  // namespace runcert
