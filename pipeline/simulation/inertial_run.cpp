#include "simulation/inertial_run.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/failure.h"
#include "core/random.h"

namespace runcert {
namespace {

constexpr int ticks_hz = 400;
constexpr double tick_s = 1.0 / ticks_hz;
constexpr double two_pi = 2.0 * std::numbers::pi;

double radians(double degrees) {
    return degrees * radians_per_degree;
}

/// 0 before 0, 1 after 1, with two continuous derivatives.
double smooth_step(double x) {
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

/// Two tones: 0.8 and 0.2 of the amplitude.
double oscillation(double time_s, double hz, double phase) {
    return 0.8 * std::sin(two_pi * hz * time_s + phase) +
           0.2 * std::sin(two_pi * 1.7 * hz * time_s + 2.0 * phase);
}

/// Velocity and attitude of a craft, and the ground that it is on.
struct CraftState {
    Eigen::Vector3d velocity_m_s;
    Eigen::Matrix3d enu_from_body;
    Eigen::Vector3d ground_normal;
};

/// The normal of ground along a course that rises by `slope` and leans by `roll` across it.
Eigen::Vector3d normal_of(double course, double slope, double roll) {
    return -rotation_of({.roll = roll, .pitch = std::atan(slope), .heading = course}).col(2);
}

/// Velocity and attitude at each tick, in order.
class Craft {
  public:
    Craft(const InertialRunSpec& spec, RandomGenerator& random)
        : spec_(spec), way_m_(spec.start_m) {
        for (double& phase : phases_)
            phase = two_pi * random.uniform();
    }

    CraftState at(std::int64_t tick) {
        const double time_s = static_cast<double>(tick) * tick_s - spec_.stand_s;
        return spec_.course == InertialCourse::oval ? on_the_oval(time_s) : on_the_lake(time_s);
    }

  private:
    CraftState on_the_lake(double time_s) const {
        // A craft that stands sets off smoothly; one that is recorded on its way has a speed.
        const bool from_rest = spec_.stand_s > 0.0;
        const double moving = from_rest ? smooth_step(time_s / 15.0) : 1.0;
        const double logistic = 1.0 / (1.0 + std::exp(-(time_s - 25.0) / 6.0));
        const double speed =
            moving * spec_.speed_m_s / 60.0 *
            (10.0 + 50.0 * logistic + std::sin(two_pi * 0.07 * time_s + phases_[0]) +
             0.3 * std::sin(two_pi * 0.31 * time_s + phases_[1]));
        const double turning_s = std::max(time_s, 0.0);  // a craft that stands keeps its attitude
        const double course =
            radians(62.0 + 1.5 * std::sin(two_pi * 0.03 * turning_s + phases_[2]) +
                    0.5 * std::sin(two_pi * 0.11 * turning_s + phases_[3]));
        const double slope = 0.002 * std::sin(two_pi * 0.05 * turning_s + phases_[4]);
        const double leeway = radians(spec_.leeway_deg) *
                              (1.0 + 0.2 * std::sin(two_pi * 0.2 * turning_s + phases_[5]));
        const double roll =
            radians(spec_.roll_deg) * moving * oscillation(time_s, spec_.roll_hz, phases_[6]);
        const double pitch = radians(spec_.pitch_deg) * moving *
                                 oscillation(time_s, 1.3 * spec_.roll_hz, phases_[7]) +
                             slope;
        return {speed * Eigen::Vector3d(std::sin(course), std::cos(course), slope),
                rotation_of({.roll = roll, .pitch = pitch, .heading = course - leeway}),
                normal_of(course, slope, 0.0)};
    }

    CraftState on_the_oval(double time_s) {
        constexpr double straight_m = 600.0, radius_m = 320.0, entry_m = 150.0;
        const double turn_m = std::numbers::pi * radius_m + entry_m;  // half a turn
        const double lap_m = straight_m + turn_m;
        const double moving = spec_.stand_s > 0.0 ? smooth_step(time_s / 20.0) : 1.0;
        const double at = std::fmod(way_m_, lap_m) - straight_m;
        const double bend =
            smooth_step(at / entry_m) - smooth_step((at - turn_m + entry_m) / entry_m);
        const double speed =
            moving * (75.0 - 6.0 * bend + 3.0 * std::sin(two_pi * 0.03 * time_s + phases_[0]));
        const double curvature = -bend / radius_m;  // to the left
        if (time_s > 0.0) {
            way_m_ += speed * tick_s;
            course_ += curvature * speed * tick_s;
        }
        const double bank = radians(3.0 + 11.0 * bend);
        const double lateral_g = speed * speed * curvature / 9.81;
        const double slip = radians(0.4) * bend;
        // The craft leans out of the turn on its springs, against the bank.
        const double roll =
            -bank - radians(0.5) * lateral_g +
            radians(spec_.roll_deg) * moving * oscillation(time_s, spec_.roll_hz, phases_[6]);
        const double pitch = radians(spec_.pitch_deg) * moving *
                             oscillation(time_s, 1.3 * spec_.roll_hz, phases_[7]);
        const double climb = 0.3 * moving * std::sin(two_pi * 0.04 * time_s + phases_[4]);
        return {{speed * std::sin(course_), speed * std::cos(course_), climb},
                rotation_of({.roll = roll, .pitch = pitch, .heading = course_ + slip}),
                normal_of(course_, speed > 0.0 ? climb / speed : 0.0, -bank)};
    }

    const InertialRunSpec& spec_;
    double phases_[8] = {};
    double way_m_;
    double course_ = radians(40.0);
};

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
class ImuErrors {
  public:
    ImuErrors(const InertialRunSpec& spec, RandomGenerator& random)
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

InertialTruth truth_at(const NavigationState& state, const Eigen::Vector3d& rate,
                       const ImuBias& bias, const Eigen::Vector3d& ground_normal,
                       const InertialRunSpec& spec) {
    const Eigen::Matrix3d& c = state.enu_from_body;
    return {.imu = state,
            .antenna_m = state.position_m + c * spec.antenna_m,
            .reference_point_m = state.position_m + c * spec.reference_point_m,
            .reference_velocity_m_s = state.velocity_m_s + c * rate.cross(spec.reference_point_m),
            .bias = bias,
            .ground_normal = ground_normal};
}

}  // namespace

InertialRun simulate_inertial(const InertialRunSpec& spec) {
    require_possible(spec);
    const EarthFrame earth(spec.origin);
    // One sequence for each kind of draw, so that a size changes no other draw.
    RandomGenerator shapes(spec.seed), imu_draws(spec.seed + 1'000'003),
        fix_draws(spec.seed + 2'000'003), second_draws(spec.seed + 3'000'003);
    Craft craft(spec, shapes);
    ImuErrors imu_errors(spec, imu_draws);
    FixErrors fix_errors(spec, fix_draws), second_errors(spec, second_draws);
    const auto ticks = static_cast<std::int64_t>((spec.stand_s + spec.duration_s) * ticks_hz);
    const std::int64_t per_sample = ticks_hz / spec.imu_hz;
    const std::int64_t per_fix = ticks_hz / spec.position_hz;
    const std::int64_t late = std::llround(spec.time_offset_s * ticks_hz);
    InertialRun run;
    CraftState now = craft.at(0);
    NavigationState state{.enu_from_body = now.enu_from_body, .velocity_m_s = now.velocity_m_s};
    ImuSample sum;
    Eigen::Vector3d begin_velocity_m_s = state.velocity_m_s;
    for (std::int64_t tick = 0; tick <= ticks; ++tick) {
        const CraftState next = craft.at(tick + 1);
        const double end_s = static_cast<double>(tick + 1) * tick_s;
        const ImuSample piece = sample_between(state, next, end_s, earth);
        const Eigen::Vector3d rate =
            piece.angle_rad / tick_s - state.enu_from_body.transpose() * earth.rotation_rad_s();
        if ((tick - late) % per_fix == 0 && tick >= late) {
            InertialTruth truth = truth_at(state, rate, imu_errors.bias(), now.ground_normal, spec);
            truth.time_s = static_cast<double>(tick - late) * tick_s;
            const Eigen::Vector3d sigma(spec.white_horizontal_m, spec.white_horizontal_m,
                                        spec.white_vertical_m);
            run.fixes.push_back(
                {.time_s = truth.time_s,
                 .enu_m = truth.antenna_m + fix_errors.next(),
                 .covariance_m2 = sigma.cwiseProduct(sigma).asDiagonal().toDenseMatrix()});
            run.truth.push_back(truth);
            if (spec.second_antenna_m) {
                PositionFix second = run.fixes.back();
                second.enu_m = state.position_m + state.enu_from_body * *spec.second_antenna_m +
                               second_errors.next();
                run.second_fixes.push_back(second);
            }
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
