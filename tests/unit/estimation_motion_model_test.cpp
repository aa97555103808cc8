#include <gtest/gtest.h>

#include <Eigen/LU>

#include "estimation/motion_model.h"

namespace runcert {
namespace {

const MotionModel model{.jerk_density = 0.7};

/// Process noise by its definition: the integral of F(t) g q g' F(t)' over the step.
Eigen::Matrix3d integrated_noise(double dt_s) {
    constexpr int steps = 20000;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < steps; ++i) {
        const double t = (i + 0.5) * dt_s / steps;
        const Eigen::Vector3d column = axis_transition(t).col(2);
        sum += column * column.transpose() * (dt_s / steps);
    }
    return model.jerk_density * model.jerk_density * sum;
}

TEST(MotionModel, ProcessNoiseIsTheIntegralOfWhiteJerk) {
    for (const double dt_s : {0.05, 0.1, 1.0}) {
        const Eigen::Matrix3d expected = integrated_noise(dt_s);
        const Eigen::Matrix3d actual = axis_process_noise(model, dt_s);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                EXPECT_NEAR(actual(i, j) / expected(i, j), 1.0, 1e-8) << dt_s << " " << i << j;
    }
}

TEST(MotionModel, TwoStepsAreOneStepOfTheirSum) {
    const double a = 0.13;
    const double b = 0.29;
    EXPECT_TRUE((axis_transition(b) * axis_transition(a)).isApprox(axis_transition(a + b), 1e-14));
    const Eigen::Matrix3d two =
        axis_transition(b) * axis_process_noise(model, a) * axis_transition(b).transpose() +
        axis_process_noise(model, b);
    EXPECT_TRUE(two.isApprox(axis_process_noise(model, a + b), 1e-13));
}

TEST(MotionModel, WhitenerSquaredIsTheInverse) {
    // A bug of this kind is known from elsewhere: with information L L' the factor is L', not L.
    for (const double dt_s : {0.01, 0.1, 1.0}) {
        const Eigen::Matrix3d whitener = axis_process_whitener(model, dt_s);
        const Eigen::Matrix3d noise = axis_process_noise(model, dt_s);
        const Eigen::Matrix3d unit = whitener * noise * whitener.transpose();
        EXPECT_TRUE(unit.isIdentity(1e-9)) << unit;
        const Eigen::Vector3d residual(3e-4 * dt_s * dt_s, -2e-3 * dt_s, 0.05);
        const double expected = residual.dot(noise.inverse() * residual);
        EXPECT_NEAR((whitener * residual).squaredNorm() / expected, 1.0, 1e-8);
    }
}

TEST(MotionModel, AxesDoNotMix) {
    const StateMatrix<3> f = transition<3>(0.5);
    StateVector<3> state;
    state << 1, 2, 3, 10, 20, 30, 4, 8, 12;
    StateVector<3> expected;
    expected << 1 + 5 + 0.5, 2 + 10 + 1, 3 + 15 + 1.5, 12, 24, 36, 4, 8, 12;
    EXPECT_TRUE((f * state).isApprox(expected, 1e-14));
    const StateMatrix<3> q = process_noise<3>(model, 0.5);
    EXPECT_EQ(q(0, 1), 0.0);
    EXPECT_EQ(q(0, 3), axis_process_noise(model, 0.5)(0, 1));
    EXPECT_EQ(q(4, 7), axis_process_noise(model, 0.5)(1, 2));
}

}  // namespace
}  // namespace runcert
