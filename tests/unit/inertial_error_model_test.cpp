#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "inertial/attitude.h"
#include "inertial/inertial_filter.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace error_state;

/// A craft in a turn, 3 km from the origin.
struct Case {
    EarthFrame earth{{.latitude = Angle::from_degrees(40.1),
                      .longitude = Angle::from_degrees(-105.1),
                      .height_m = 1600.0}};
    InertialNominal nominal;
    Eigen::Vector3d rate{0.4, -0.3, 0.6};
    Eigen::Vector3d force{3.0, -4.0, -9.0};

    Case() {
        nominal.state = {.enu_from_body = rotation_of({0.3, -0.1, 2.0}),
                         .velocity_m_s = {40.0, -50.0, 2.0},
                         .position_m = {2000.0, -2200.0, 30.0}};
        nominal.bias = {{1e-3, -2e-3, 5e-4}, {0.02, 0.01, -0.03}};
        nominal.antenna_m = {0.4, -0.3, -5.0};
        nominal.position_error_m = {0.01, -0.02, 0.03};
    }

    ImuSample sample(double dt) const {
        return {.interval_s = dt,
                .angle_rad = dt * (rate + nominal.bias.gyro_rad_s),
                .velocity_m_s = dt * (force + nominal.bias.accelerometer_m_s2)};
    }

    InertialNominal carried(InertialNominal from, double dt, int steps,
                            const PositionErrorModel& error) const {
        for (int i = 0; i < steps; ++i)
            from.state = strapdown_step(from.state, sample(dt), from.bias, earth).state;
        from.position_error_m *= std::exp(-dt * steps / error.time_s);
        return from;
    }
};

/// Size of a deviation whose effect is linear to nine digits, for each state.
double step_of(int state) {
    if (state < velocity) return 1e-5;
    if (state < gyro_bias) return 1e-1;
    if (state < accelerometer_bias) return 1e-4;
    return 1e-3;
}

ErrorMatrix numeric_transition(const Case& at, double dt, int steps,
                               const PositionErrorModel& error) {
    ErrorMatrix numeric;
    for (int j = 0; j < size; ++j) {
        const ErrorVector d = step_of(j) * ErrorVector::Unit(j);
        const InertialNominal plus = at.carried(corrected(at.nominal, d), dt, steps, error);
        const InertialNominal minus = at.carried(corrected(at.nominal, -d), dt, steps, error);
        numeric.col(j) = deviation(plus, minus) / (2.0 * step_of(j));
    }
    return numeric;
}

// For a step so short that only F matters: each block against the mechanisation's own differences.
TEST(ErrorModel, TransitionIsThatOfDifferences) {
    const Case at;
    const PositionErrorModel error;
    constexpr double dt = 1e-3;
    const InertialNominal half = at.carried(at.nominal, 0.5 * dt, 1, error);
    const ErrorStep step{.dt_s = dt,
                         .enu_from_body = half.state.enu_from_body,
                         .specific_force_m_s2 = half.state.enu_from_body * at.force};
    const ErrorMatrix analytic = error_transition(step, error, at.earth).matrix();
    const ErrorMatrix numeric = numeric_transition(at, dt, 1, error);
    const double largest = ((analytic - ErrorMatrix::Identity()) / dt).cwiseAbs().maxCoeff();
    EXPECT_GT(largest, 5.0);
    for (int i = 0; i < lever_arm; i += 3)
        for (int j = 0; j < lever_arm; j += 3)
            EXPECT_LT(((analytic - numeric).block<3, 3>(i, j) / dt).cwiseAbs().maxCoeff(),
                      1e-5 * largest)
                << i << " " << j;
}

// Over the step that the filter takes, 20 ms, terms of the third order remain.
TEST(ErrorModel, TransitionOverTheFiltersStepIsGoodToItsOrder) {
    const Case at;
    const PositionErrorModel error;
    const InertialNominal half = at.carried(at.nominal, 0.01, 1, error);
    const InertialNominal end = at.carried(at.nominal, 0.01, 2, error);
    const ErrorStep step{
        .dt_s = 0.02,
        .enu_from_body = 0.5 * (at.nominal.state.enu_from_body + end.state.enu_from_body),
        .specific_force_m_s2 = half.state.enu_from_body * at.force};
    const ErrorMatrix analytic = error_transition(step, error, at.earth).matrix();
    const ErrorMatrix numeric = numeric_transition(at, 0.01, 2, error);
    EXPECT_LT((analytic - numeric).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((analytic - numeric).leftCols<3>().cwiseAbs().maxCoeff(), 2e-5);
}

TEST(ErrorModel, JacobiansAreThoseOfDifferences) {
    const Case at;
    const auto predicted = [&](const InertialNominal& x, double offset_s) -> Eigen::Vector3d {
        const Eigen::Matrix3d& c = x.state.enu_from_body;
        const Eigen::Vector3d v = x.state.velocity_m_s + c * at.rate.cross(x.antenna_m);
        return x.state.position_m + c * x.antenna_m + x.position_error_m + offset_s * v;
    };
    const Eigen::Vector3d velocity_m_s =
        at.nominal.state.velocity_m_s +
        at.nominal.state.enu_from_body * at.rate.cross(at.nominal.antenna_m);
    const auto analytic =
        position_jacobian(at.nominal.state.enu_from_body, at.nominal.antenna_m, velocity_m_s);
    for (int j = 0; j < size; ++j) {
        const double h = step_of(j);
        const ErrorVector d = h * ErrorVector::Unit(j);
        const InertialNominal plus = corrected(at.nominal, d);
        const InertialNominal minus = corrected(at.nominal, -d);
        const Eigen::Vector3d numeric =
            (predicted(plus, plus.time_offset_s) - predicted(minus, minus.time_offset_s)) /
            (2.0 * h);
        EXPECT_LT((numeric - analytic.col(j)).norm(), 1e-6) << j;
    }
}

TEST(ErrorModel, PointsMoveAsTheirJacobians) {
    const Case at;
    const Eigen::Vector3d arm(1.0, -0.5, 2.0);
    const auto velocity_of = [&](const InertialNominal& x) -> Eigen::Vector3d {
        const Eigen::Vector3d rate = at.rate + at.nominal.bias.gyro_rad_s - x.bias.gyro_rad_s;
        return x.state.velocity_m_s + x.state.enu_from_body * rate.cross(arm);
    };
    const auto analytic = point_velocity_jacobian(at.nominal.state.enu_from_body, arm, at.rate);
    for (int j = 0; j < size; ++j) {
        const double h = step_of(j);
        const ErrorVector d = h * ErrorVector::Unit(j);
        const Eigen::Vector3d numeric =
            (velocity_of(corrected(at.nominal, d)) - velocity_of(corrected(at.nominal, -d))) /
            (2.0 * h);
        EXPECT_LT((numeric - analytic.col(j)).norm(), 1e-6) << j;
    }
}

TEST(ErrorModel, CorrectionsAndDeviationsAreEachOthersInverse) {
    const Case at;
    RandomGenerator random(1);
    ErrorVector d;
    for (int j = 0; j < size; ++j)
        d(j) = 0.1 * random.normal();
    EXPECT_LT((deviation(corrected(at.nominal, d), at.nominal) - d).norm(), 1e-12);
}

// In closed form: white acceleration noise makes q t in velocity, q t^2 / 2 across, q t^3 / 3 in
// position; white rate noise likewise in attitude, and f t^2 / 2 of it in velocity.
TEST(ErrorModel, NoiseGrowsAsItsIntegrals) {
    const Case at;
    ImuNoise noise;
    noise.velocity_walk_m_s_sqrt_s = 0.05;
    noise.angle_walk_rad_sqrt_s = 1e-3;
    const PositionErrorModel error{.horizontal_m = 0.008, .vertical_m = 0.012, .time_s = 3.0};
    ErrorStep step{.dt_s = 0.02, .specific_force_m_s2 = {0.0, 0.0, 9.8}};
    const ErrorTransition transition = error_transition(step, error, at.earth);
    const ErrorNoise added = error_noise(step, noise, error);
    ErrorMatrix p = ErrorMatrix::Zero();
    constexpr double t = 1.0;
    for (int i = 0; i < 50; ++i)
        propagate(p, transition, added);
    const double qa = 0.05 * 0.05, qg = 1e-6;
    EXPECT_NEAR(p(5, 5), qa * t, 1e-3 * qa);  // up: gravity turns no part of it
    EXPECT_NEAR(p(8, 8), qa * t * t * t / 3.0, 2e-3 * qa);
    EXPECT_NEAR(p(5, 8), qa * t * t / 2.0, 2e-3 * qa);
    EXPECT_NEAR(p(0, 0), qg * t, 1e-3 * qg);
    EXPECT_NEAR(p(3, 3), qa * t + 9.8 * 9.8 * qg / 3.0, 2e-3 * qa);
    EXPECT_NEAR(p(15, 15), 0.008 * 0.008 * -std::expm1(-2.0 * t / 3.0), 1e-12);
    EXPECT_NEAR(p(17, 17), 0.012 * 0.012 * -std::expm1(-2.0 * t / 3.0), 1e-12);
    EXPECT_EQ(p, p.transpose());
    // Noise that grows with motion adds as an independent density.
    noise.motion_sqrt_s = 0.006;
    step.rate_rad_s = 0.5;
    step.acceleration_m_s2 = 4.0;
    const ErrorNoise moving = error_noise(step, noise, error);
    EXPECT_NEAR(moving.white(0), 0.02 * (qg + 9e-6), 1e-12);
    EXPECT_NEAR(moving.white(3), 0.02 * (qa + 0.024 * 0.024), 1e-12);
}

// Data sheets: 1 deg/h, 0.125 deg/sqrt(h), 1 mg and so on.
TEST(ErrorModel, GradesAreTheirDataSheets) {
    const ImuNoise tactical = imu_noise(ImuClass::tactical);
    EXPECT_NEAR(tactical.gyro_bias_rad_s, 4.848e-6, 1e-9);
    EXPECT_NEAR(tactical.angle_walk_rad_sqrt_s, 3.636e-5, 1e-8);
    EXPECT_NEAR(tactical.accelerometer_bias_m_s2, 9.80665e-3, 1e-9);
    EXPECT_NEAR(tactical.velocity_walk_m_s_sqrt_s, 1e-3, 1e-12);
    const ImuNoise consumer = imu_noise(ImuClass::consumer);
    EXPECT_NEAR(consumer.angle_walk_rad_sqrt_s * degrees_per_radian, 0.0038, 5e-5);
    EXPECT_NEAR(consumer.velocity_walk_m_s_sqrt_s / 9.80665, 150e-6, 5e-6);
    const ImuNoise mems = imu_noise(ImuClass::mems), craft = on_a_craft(mems);
    EXPECT_NEAR(craft.velocity_walk_m_s_sqrt_s / mems.velocity_walk_m_s_sqrt_s, 10.0, 1e-12);
    EXPECT_NEAR(craft.angle_walk_rad_sqrt_s / mems.angle_walk_rad_sqrt_s, 2.0, 1e-12);
    EXPECT_EQ(craft.motion_sqrt_s, 0.006);
    EXPECT_EQ(mems.motion_sqrt_s, 0.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
