#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "motion/motion_model.h"

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

std::vector<double> grid(std::size_t count, double dt_s) {
    std::vector<double> times_s;
    for (std::size_t k = 0; k < count; ++k)
        times_s.push_back(dt_s * static_cast<double>(k));
    return times_s;
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
         {GaussMarkovError::steady(sigma_m, 0.7), GaussMarkovError::bounding(sigma_m, 0.5, 10.0)}) {
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

TEST(GaussMarkov, BoundingProcessHasThePublishedParameters) {
    // Langel, Garcia Crespo & Joerger 2021, "Overbounding the effect of uncertain Gauss-Markov
    // noise in Kalman filtering", Navigation 68(2): tau = tau_max, steady variance
    // sigma^2 tau_max / tau_min, initial variance 2 sigma^2 / (1 + tau_min / tau_max).
    const GaussMarkovError error = GaussMarkovError::bounding(sigma_m, 0.5, 10.0);
    EXPECT_EQ(error.tau_s, 10.0);
    EXPECT_NEAR(error.process_density * error.process_density,
                2.0 / 10.0 * sigma_m * sigma_m * (10.0 / 0.5), 1e-18);
    EXPECT_NEAR(error.initial_sigma_m * error.initial_sigma_m,
                2.0 * sigma_m * sigma_m / (1.0 + 0.5 / 10.0), 1e-18);
    const double late = covariance_at(error, {0.0, 1e3})(1, 1);
    EXPECT_NEAR(late / (sigma_m * sigma_m * 20.0), 1.0, 1e-12);
    // Where the correlation time is known the bound is the steady process itself.
    const GaussMarkovError known = GaussMarkovError::bounding(sigma_m, 2.0, 2.0);
    EXPECT_DOUBLE_EQ(known.initial_sigma_m, sigma_m);
    EXPECT_DOUBLE_EQ(known.process_density, GaussMarkovError::steady(sigma_m, 2.0).process_density);
}

TEST(GaussMarkov, BoundingProcessWandersAtLeastAsFarAsEverySteadyOne) {
    // Structure function: the variance of the change over a lag, from any epoch of the arc on.
    const std::vector<double> times_s = grid(80, 0.5);
    const Eigen::MatrixXd bound =
        covariance_at(GaussMarkovError::bounding(sigma_m, 0.5, 10.0), times_s);
    for (double tau_s = 0.5; tau_s < 10.01; tau_s *= 1.1)
        for (Eigen::Index s = 0; s < 80; ++s)
            for (Eigen::Index e = s; e < 80; ++e) {
                const double lag_s = 0.5 * static_cast<double>(e - s);
                const double steady = -2.0 * sigma_m * sigma_m * std::expm1(-lag_s / tau_s);
                const double bounding = bound(s, s) + bound(e, e) - 2.0 * bound(s, e);
                EXPECT_GE(bounding, steady * (1.0 - 1e-12)) << tau_s << " " << s << " " << e;
            }
}

/// Smallest eigenvalue of the difference of two covariances over some epochs, in units of sigma^2.
double margin(const GaussMarkovError& bounding, const GaussMarkovError& bounded,
              const std::vector<double>& times_s) {
    const Eigen::MatrixXd difference =
        covariance_at(bounding, times_s) - covariance_at(bounded, times_s);
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues().minCoeff() /
           (sigma_m * sigma_m);
}

/// The smallest over the steady processes between two correlation times.
double smallest_margin(const GaussMarkovError& bounding, double dt_s, double tau_min_s,
                       double tau_max_s) {
    const std::vector<double> times_s = grid(40, dt_s);
    constexpr int steps = 16;
    double smallest = 1e9;
    for (int i = 0; i <= steps; ++i) {
        const double tau_s =
            tau_min_s * std::pow(tau_max_s / tau_min_s, static_cast<double>(i) / steps);
        smallest =
            std::min(smallest, margin(bounding, GaussMarkovError::steady(sigma_m, tau_s), times_s));
    }
    return smallest;
}

TEST(GaussMarkov, BoundingProcessBoundsEveryLinearCombination) {
    // What makes it a bound of any weighted sum of the errors: its covariance over any epochs less
    // that of the steady process is positive semidefinite, for correlation times from tau_min to
    // tau_max^2 / tau_min, here 200 s.
    const GaussMarkovError bounding = GaussMarkovError::bounding(sigma_m, 0.5, 10.0);
    for (const double dt_s : {0.02, 0.1, 1.0, 5.0, 50.0})
        EXPECT_GT(smallest_margin(bounding, dt_s, 0.5, 200.0), -1e-11) << dt_s;
    // It is no larger than it must be: neither a smaller beginning nor less noise would do.
    GaussMarkovError less = bounding;
    less.initial_sigma_m *= 0.98;
    EXPECT_LT(smallest_margin(less, 0.02, 0.5, 10.0), -1e-4);
    less = bounding;
    less.process_density *= 0.98;
    EXPECT_LT(smallest_margin(less, 0.02, 0.5, 10.0), -1e-4);
    // Nor does it bound what forgets sooner, or hardly at all over a long arc.
    EXPECT_LT(smallest_margin(bounding, 0.02, 0.45, 0.45), -1e-4);
    EXPECT_LT(smallest_margin(bounding, 50.0, 1e4, 1e4), -1e-4);
}

TEST(GaussMarkov, BoundingProcessHoldsAtEpochsOfAnyDistance) {
    const GaussMarkovError bounding = GaussMarkovError::bounding(sigma_m, 0.5, 10.0);
    const std::vector<double> times_s{0.0, 0.01, 0.5,  0.52,  3.0,  3.1,
                                      3.2, 30.0, 33.0, 180.0, 999.0};
    for (const double tau_s : {0.5, 0.8, 3.0, 10.0, 60.0, 200.0})
        EXPECT_GT(margin(bounding, GaussMarkovError::steady(sigma_m, tau_s), times_s), -1e-11)
            << tau_s;
}

TEST(GaussMarkov, BoundOfADiffusionHoldsForEveryErrorThatWandersAsFast) {
    // sigma sqrt(2 / tau) = 10 mm/s^0.5, whatever the correlation time up to the longest: the
    // covariance of the steady one with the longest less theirs is positive semidefinite.
    constexpr double diffusion = 0.010;
    const GaussMarkovError bounding = GaussMarkovError::bounding_diffusion(diffusion, 10.0);
    EXPECT_EQ(bounding.tau_s, 10.0);
    EXPECT_DOUBLE_EQ(bounding.process_density, diffusion);
    EXPECT_GE(bounding.initial_sigma_m * bounding.initial_sigma_m,
              0.5 * diffusion * diffusion * 10.0 * (1.0 - 1e-15));
    const auto wandering = [](double tau_s) {
        return GaussMarkovError::steady(diffusion * std::sqrt(0.5 * tau_s), tau_s);
    };
    for (const double dt_s : {0.02, 0.1, 1.0, 5.0})
        for (const double tau_s : {0.1, 0.5, 2.0, 5.0, 9.9})
            EXPECT_GT(margin(bounding, wandering(tau_s), grid(40, dt_s)), -1e-11)
                << dt_s << " " << tau_s;
    EXPECT_LT(margin(bounding, wandering(11.0), grid(40, 1.0)), -1e-4);
    // With the beginning of the bound of a size, 0.48 d^2 for these times, it is none.
    GaussMarkovError short_of_it = bounding;
    short_of_it.initial_sigma_m = std::sqrt(0.48) * diffusion;
    EXPECT_LT(margin(short_of_it, wandering(9.9), grid(40, 0.1)), -1e-4);
}

TEST(GaussMarkov, TheLargerOfTwoBoundsBoundsWhatEitherBounds) {
    const GaussMarkovError of_size = GaussMarkovError::bounding(sigma_m, 0.5, 10.0);
    for (const double diffusion : {0.002, 0.010, 0.030}) {
        const GaussMarkovError of_diffusion = GaussMarkovError::bounding_diffusion(diffusion, 10.0);
        const GaussMarkovError larger = GaussMarkovError::larger(of_size, of_diffusion);
        for (const double dt_s : {0.02, 1.0}) {
            EXPECT_GT(margin(larger, of_size, grid(40, dt_s)), -1e-11) << diffusion;
            EXPECT_GT(margin(larger, of_diffusion, grid(40, dt_s)), -1e-11) << diffusion;
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
