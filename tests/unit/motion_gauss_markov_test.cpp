#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double sigma_m = 0.008;

AxisStep step_of(const GaussMarkovError& error, double dt_s) {
    EstimationModel model;
    model.error = error;
    return axis_step(model, dt_s);
}

/// Covariance of the error at the given times, the first of them the beginning of an arc.
Eigen::MatrixXd covariance_at(const GaussMarkovError& error, const std::vector<double>& times_s) {
    const auto n = static_cast<Eigen::Index>(times_s.size());
    Eigen::MatrixXd covariance(n, n);
    covariance(0, 0) = error.initial_sigma_m * error.initial_sigma_m;
    for (Eigen::Index k = 1; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const AxisStep step = step_of(error, times_s[at] - times_s[at - 1]);
        covariance.row(k).head(k) = step.error_transition * covariance.row(k - 1).head(k);
        covariance.col(k).head(k) = covariance.row(k).head(k).transpose();
        covariance(k, k) =
            step.error_transition * step.error_transition * covariance(k - 1, k - 1) +
            step.error_noise;
    }
    return covariance;
}

TEST(GaussMarkov, StepIsThatOfYsm22) {
    // phi = exp(-dt/tau), q = sigma^2 (1 - exp(-2 dt/tau)).
    for (const double tau_s : {0.5, 2.0, 10.0, 1e4})
        for (const double dt_s : {1e-3, 0.1, 1.0, 30.0}) {
            const AxisStep step = step_of(GaussMarkovError::steady(sigma_m, tau_s), dt_s);
            EXPECT_DOUBLE_EQ(step.error_transition, std::exp(-dt_s / tau_s));
            EXPECT_NEAR(step.error_noise / (-sigma_m * sigma_m * std::expm1(-2 * dt_s / tau_s)),
                        1.0, 1e-15);
        }
}

TEST(GaussMarkov, SteadyErrorKeepsItsVariance) {
    const GaussMarkovError error = GaussMarkovError::steady(sigma_m, 2.0);
    EXPECT_EQ(error.initial_sigma_m, sigma_m);
    EXPECT_EQ(error.tau_s, 2.0);
    const Eigen::MatrixXd covariance =
        covariance_at(error, {0.0, 1e-3, 0.1, 0.35, 1.0, 4.0, 4.1, 60.0});
    for (Eigen::Index k = 0; k < covariance.rows(); ++k)
        EXPECT_NEAR(covariance(k, k) / (sigma_m * sigma_m), 1.0, 1e-14) << k;
    EXPECT_NEAR(covariance(2, 4) / (sigma_m * sigma_m), std::exp(-0.9 / 2.0), 1e-14);
}

TEST(GaussMarkov, TwoStepsAreOneStepOfTheirSum) {
    for (const GaussMarkovError& error :
         {GaussMarkovError::steady(sigma_m, 0.7), test::growing_error}) {
        const AxisStep a = step_of(error, 0.13);
        const AxisStep b = step_of(error, 0.29);
        const AxisStep whole = step_of(error, 0.42);
        EXPECT_NEAR(a.error_transition * b.error_transition, whole.error_transition, 1e-15);
        EXPECT_NEAR((b.error_transition * b.error_transition * a.error_noise + b.error_noise) /
                        whole.error_noise,
                    1.0, 1e-14);
    }
}

TEST(GaussMarkov, NoErrorIsTenMicrometres) {
    for (const GaussMarkovError& error :
         {EstimationModel{}.error, GaussMarkovError::steady(0.0, 3.0),
          GaussMarkovError::steady(1e-7, 3.0)}) {
        EXPECT_EQ(error.initial_sigma_m, 1e-5);
        EXPECT_NEAR(error.process_density * error.process_density * error.tau_s / 2, 1e-10, 1e-24);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
