#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::Quad;
using test::QuadMatrix;

EstimationModel singer(double jerk_density, double acceleration_time_s) {
    return {.motion = {.jerk_density = jerk_density, .acceleration_time_s = acceleration_time_s}};
}

const EstimationModel persistent{.motion = {.jerk_density = 0.7}};

/// Largest deviation of an element, relative to it.
double largest_relative(const Eigen::Matrix3d& actual, const Eigen::Matrix3d& expected) {
    double largest = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (expected(i, j) == 0.0)
                EXPECT_EQ(actual(i, j), 0.0) << i << j;
            else
                largest = std::max(largest, std::abs(actual(i, j) / expected(i, j) - 1.0));
    return largest;
}

/// The published closed form of a Singer step: Singer 1970 (appendix); Bar-Shalom, Li &
/// Kirubarajan 2001, "Estimation with applications to tracking and navigation", 8.2. Evaluated
/// with 100 digits, as its differences lose many of them where alpha T is small.
using Many = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_100::backend_type,
                                           boost::multiprecision::et_off>;
using ManyMatrix = Eigen::Matrix<Many, 3, 3>;
struct SingerStep {
    Eigen::Matrix3d transition;
    Eigen::Matrix3d process_noise;
};
SingerStep published_singer(double jerk_density, double acceleration_time_s, double dt_s) {
    const Many a = 1 / Many(acceleration_time_s);
    const Many t = dt_s;
    const Many x = a * t;
    const Many e = exp(-x);
    ManyMatrix f;
    f << 1, t, (x - 1 + e) / (a * a), 0, 1, (1 - e) / a, 0, 0, e;
    const Many q = Many(jerk_density) * jerk_density;  // Singer's 2 alpha sigma_m^2
    const Many q11 =
        (1 - e * e + 2 * x + 2 * x * x * x / 3 - 2 * x * x - 4 * x * e) / (2 * pow(a, 5));
    const Many q12 = (e * e + 1 - 2 * e + 2 * x * e - 2 * x + x * x) / (2 * pow(a, 4));
    const Many q13 = (1 - e * e - 2 * x * e) / (2 * pow(a, 3));
    const Many q22 = (4 * e - 3 - e * e + 2 * x) / (2 * pow(a, 3));
    const Many q23 = (e * e + 1 - 2 * e) / (2 * a * a);
    const Many q33 = (1 - e * e) / (2 * a);
    ManyMatrix noise;
    noise << q11, q12, q13, q12, q22, q23, q13, q23, q33;
    return {f.cast<double>(), (q * noise).eval().cast<double>()};
}

/// The moments of the model's own differential equations, da = -a / tau dt + q dw, integrated by
/// the classical Runge-Kutta method.
SingerStep integrated(const MotionModel& motion, double dt_s) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    a(0, 1) = a(1, 2) = 1.0;
    a(2, 2) = -1.0 / motion.acceleration_time_s;
    Eigen::Matrix3d driving = Eigen::Matrix3d::Zero();
    driving(2, 2) = motion.jerk_density * motion.jerk_density;
    SingerStep now{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero()};
    constexpr int steps = 2000;
    const double h = dt_s / steps;
    const auto slope = [&](const SingerStep& at) {
        return SingerStep{a * at.transition,
                          a * at.process_noise + at.process_noise * a.transpose() + driving};
    };
    const auto moved = [](const SingerStep& from, const SingerStep& by, double factor) {
        return SingerStep{from.transition + factor * by.transition,
                          from.process_noise + factor * by.process_noise};
    };
    for (int i = 0; i < steps; ++i) {
        const SingerStep k1 = slope(now);
        const SingerStep k2 = slope(moved(now, k1, h / 2));
        const SingerStep k3 = slope(moved(now, k2, h / 2));
        const SingerStep k4 = slope(moved(now, k3, h));
        now = moved(moved(moved(moved(now, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    }
    return now;
}

TEST(MotionModel, PersistentAccelerationHasItsClosedForm) {
    for (const double t : {1e-9, 1e-3, 0.05, 0.1, 0.2, 1.0, 30.0}) {
        const AxisStep step = axis_step(persistent, t);
        Eigen::Matrix3d f;
        f << 1, t, t * t / 2, 0, 1, t, 0, 0, 1;
        Eigen::Matrix3d q;
        q << std::pow(t, 5) / 20, std::pow(t, 4) / 8, std::pow(t, 3) / 6,  //
            std::pow(t, 4) / 8, std::pow(t, 3) / 3, t * t / 2,             //
            std::pow(t, 3) / 6, t * t / 2, t;
        EXPECT_LT(largest_relative(step.transition, f), 1e-14) << t;
        EXPECT_LT(largest_relative(step.process_noise, 0.7 * 0.7 * q), 1e-14) << t;
        EXPECT_EQ(step.dt_s, t);
    }
}

TEST(MotionModel, SingerHasItsPublishedClosedForm) {
    for (const double tau_s : {0.2, 1.0, 3.0, 40.0, 1e3})
        for (const double dt_s : {1e-3, 0.05, 0.1, 0.5, 1.0, 2.0}) {
            const AxisStep step = axis_step(singer(1.3, tau_s), dt_s);
            const SingerStep expected = published_singer(1.3, tau_s, dt_s);
            EXPECT_LT(largest_relative(step.transition, expected.transition), 1e-14)
                << tau_s << " " << dt_s;
            EXPECT_LT(largest_relative(step.process_noise, expected.process_noise), 1e-13)
                << tau_s << " " << dt_s;
        }
}

TEST(MotionModel, StepIsTheSolutionOfTheDifferentialEquations) {
    for (const double tau_s : {0.3, 2.0, std::numeric_limits<double>::infinity()})
        for (const double dt_s : {0.1, 1.0}) {
            const EstimationModel model = singer(0.8, tau_s);
            const AxisStep step = axis_step(model, dt_s);
            const SingerStep expected = integrated(model.motion, dt_s);
            EXPECT_LT(largest_relative(step.transition, expected.transition), 1e-11) << tau_s;
            EXPECT_LT(largest_relative(step.process_noise, expected.process_noise), 1e-11)
                << tau_s << " " << dt_s;
        }
}

TEST(MotionModel, TwoStepsAreOneStepOfTheirSum) {
    for (const double tau_s : {0.2, 1.5, 1e4, std::numeric_limits<double>::infinity()})
        for (const auto& [a, b] : {std::pair(0.13, 0.29), std::pair(0.05, 0.05)}) {
            const AxisStep first = axis_step(singer(0.7, tau_s), a);
            const AxisStep second = axis_step(singer(0.7, tau_s), b);
            const AxisStep whole = axis_step(singer(0.7, tau_s), a + b);
            EXPECT_LT(largest_relative(second.transition * first.transition, whole.transition),
                      1e-14)
                << tau_s;
            EXPECT_LT(largest_relative(
                          second.transition * first.process_noise * second.transition.transpose() +
                              second.process_noise,
                          whole.process_noise),
                      1e-13)
                << tau_s;
        }
}

TEST(MotionModel, SingerTendsToPersistentAcceleration) {
    for (const double dt_s : {0.05, 0.2, 1.0}) {
        const AxisStep limit = axis_step(persistent, dt_s);
        // What is left is of the order of the step over the correlation time.
        for (const double tau_s : {1e3, 1e6, 1e9}) {
            const AxisStep step = axis_step(singer(0.7, tau_s), dt_s);
            const double order = dt_s / tau_s;
            EXPECT_NEAR(largest_relative(step.process_noise, limit.process_noise) / order, 1.0,
                        1e-3);
            EXPECT_NEAR((1.0 - step.transition(2, 2)) / order, 1.0, 1e-3);
        }
        const AxisStep step = axis_step(singer(0.7, 1e30), dt_s);
        EXPECT_LT(largest_relative(step.process_noise, limit.process_noise), 1e-15);
        EXPECT_LT(largest_relative(step.transition, limit.transition), 1e-15);
    }
}

TEST(MotionModel, WhitenerSquaredIsTheInverse) {
    // A bug of this kind is known from elsewhere: with information L L' the factor is L', not L.
    for (const double tau_s : {0.5, std::numeric_limits<double>::infinity()})
        for (const double dt_s : {1e-6, 1e-3, 0.01, 0.1, 1.0, 10.0}) {
            const AxisStep step = axis_step(singer(0.7, tau_s), dt_s);
            const Eigen::Matrix3d whitener = axis_process_whitener(step);
            const Eigen::Matrix3d& noise = step.process_noise;
            EXPECT_TRUE((whitener * noise * whitener.transpose()).isIdentity(1e-11)) << dt_s;
            EXPECT_TRUE(whitener.isUpperTriangular(0.0)) << dt_s;
            EXPECT_TRUE((whitener.diagonal().array() > 0.0).all());
            const QuadMatrix inverse = noise.cast<Quad>().inverse();
            const Eigen::Matrix3d expected = inverse.cast<double>();
            EXPECT_LT(largest_relative(whitener.transpose() * whitener, expected), 1e-11) << dt_s;
            const Eigen::Vector3d residual(3e-4 * dt_s * dt_s, -2e-3 * dt_s, 0.05);
            EXPECT_NEAR((whitener * residual).squaredNorm() / residual.dot(expected * residual),
                        1.0, 1e-11)
                << dt_s;
        }
}

TEST(MotionModel, WhitenerOfAnyCorrelation) {
    AxisStep step = axis_step(persistent, 0.1);
    step.process_noise << 4.0, 1.2, -0.3, 1.2, 9.0, 2.0, -0.3, 2.0, 1.0;
    const Eigen::Matrix3d whitener = axis_process_whitener(step);
    const Eigen::Vector3d residual(0.3, -2.0, 1.1);
    EXPECT_NEAR((whitener * residual).squaredNorm(),
                residual.dot(step.process_noise.inverse() * residual), 1e-13);
    // The other factor of the same matrix does not do it.
    EXPECT_GT(std::abs((whitener.transpose() * residual).squaredNorm() -
                       (whitener * residual).squaredNorm()),
              0.1);
}

TEST(MotionModel, AxesDoNotMix) {
    const EstimationModel model{.motion = {.jerk_density = 0.7},
                                .error = GaussMarkovError::steady(0.008, 2.0)};
    const AxisStep step = axis_step(model, 0.5);
    StateVector<3> state;
    state << 1, 2, 3, 10, 20, 30, 4, 8, 12, 0.1, 0.2, 0.3;
    StateVector<3> expected;
    const double decay = std::exp(-0.25);
    expected << 1 + 5 + 0.5, 2 + 10 + 1, 3 + 15 + 1.5, 12, 24, 36, 4, 8, 12, 0.1 * decay,
        0.2 * decay, 0.3 * decay;
    EXPECT_TRUE((transition<3>(step) * state).isApprox(expected, 1e-14));
    const StateMatrix<3> q = process_noise<3>(step);
    for (int row = 0; row < 12; ++row)
        for (int column = 0; column < 12; ++column) {
            const bool same_axis = row % 3 == column % 3;
            const bool motion = row < 9 && column < 9;
            const double value = !same_axis      ? 0.0
                                 : motion        ? step.process_noise(row / 3, column / 3)
                                 : row == column ? step.error_noise
                                                 : 0.0;
            EXPECT_EQ(q(row, column), value) << row << " " << column;
        }
}

TEST(StepKind, HasTheNoiseOfItsOwnJerkDensity) {
    EstimationModel model = singer(0.7, 1.5);
    model.error = GaussMarkovError::steady(0.008, 2.0);
    const StepKind kind{.length_ns = 130'000'000, .jerk_factor = 5.0};
    EXPECT_DOUBLE_EQ(kind.dt_s(), 0.13);
    EstimationModel harder = model;
    harder.motion.jerk_density = 3.5;
    const AxisStep step = axis_step(model, kind);
    const AxisStep expected = axis_step(harder, 0.13);
    EXPECT_LT(largest_relative(step.process_noise, expected.process_noise), 1e-14);
    EXPECT_EQ(step.transition, expected.transition);
    EXPECT_EQ(step.error_transition, expected.error_transition);
    EXPECT_EQ(step.error_noise, expected.error_noise);
}

TEST(StepKind, IsOfTheTimeToTheNanosecondAndOfTheMotionOfTheLaterEpoch) {
    std::vector<ArcEpoch<2>> arc(3);
    for (std::size_t k = 0; k < 3; ++k)
        arc[k].time_s = 2.0 + 0.1 * static_cast<double>(k);
    arc[0].jerk_factor = 9.0;
    arc[1].jerk_factor = 4.0;
    const StepKind first = step_kind(arc[0], arc[1]);
    EXPECT_EQ(first, (StepKind{.length_ns = 100'000'000, .jerk_factor = 4.0}));
    EXPECT_EQ(step_kind(arc[1], arc[2]), (StepKind{.length_ns = 100'000'000}));
    EXPECT_NE(step_kind(arc[1], arc[2]), first);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
