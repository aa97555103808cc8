#include <gtest/gtest.h>

#include <cmath>

#include "motion/speed.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(HorizontalSpeed, UncertaintyByNumericDerivatives) {
    const Eigen::Vector2d velocity(3.0, -4.0);
    Eigen::Matrix2d covariance;
    covariance << 0.04, 0.01, 0.01, 0.09;
    const SpeedEstimate speed = horizontal_speed(velocity, covariance);
    EXPECT_DOUBLE_EQ(speed.speed_m_s, 5.0);
    Eigen::Vector2d gradient;
    for (int i = 0; i < 2; ++i) {
        Eigen::Vector2d step = Eigen::Vector2d::Zero();
        step(i) = 1e-6;
        gradient(i) = ((velocity + step).norm() - (velocity - step).norm()) / 2e-6;
    }
    EXPECT_NEAR(speed.standard_uncertainty_m_s, std::sqrt(gradient.dot(covariance * gradient)),
                1e-9);
    EXPECT_NEAR(horizontal_speed(Eigen::Vector2d::Zero(), Eigen::Vector2d(0.04, 0.09).asDiagonal())
                    .standard_uncertainty_m_s,
                0.3, 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
