#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/statistics.h"
#include "witness/velocity_witness.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;

/// A craft on a circle of 100 m at 20 m/s.
Vector2d position_at(double time_s) {
    return 100.0 * Vector2d(std::cos(0.2 * time_s), std::sin(0.2 * time_s));
}
Vector2d velocity_at(double time_s) {
    return 20.0 * Vector2d(-std::sin(0.2 * time_s), std::cos(0.2 * time_s));
}

std::vector<TimedVelocity<2>> circle(double rate_hz, double length_s, double delay_s = 0.0) {
    std::vector<TimedVelocity<2>> samples;
    for (int k = 0; k <= static_cast<int>(length_s * rate_hz); ++k) {
        const double time_s = k / rate_hz;
        samples.push_back({.time_s = time_s, .velocity = velocity_at(time_s - delay_s)});
    }
    return samples;
}

VelocityErrorModel delayed(double delay_s) {
    VelocityErrorModel model;
    model.delay_s = delay_s;
    model.density = 0.0;
    return model;
}

TEST(VelocityWitness, IntegratesAVelocityThatTurns) {
    for (const double rate_hz : {1.0, 5.0, 10.0}) {
        const VelocityWitness<2> witness(circle(rate_hz, 40.0), delayed(0.0), 0.0);
        for (const double from_s : {10.0, 10.3, 11.77}) {
            const auto moved = witness.between(from_s, from_s + 3.0);
            ASSERT_TRUE(moved);
            const Vector2d truth = position_at(from_s + 3.0) - position_at(from_s);
            EXPECT_LT((moved->displacement_m - truth).norm(), 0.06 / std::pow(rate_hz, 3) + 1e-9)
                << rate_hz << " Hz from " << from_s;
            EXPECT_NEAR(witness.path_between(from_s, from_s + 3.0).value(), 60.0,
                        0.06 / std::pow(rate_hz, 2));
        }
    }
}

TEST(VelocityWitness, TakesTheDelayOff) {
    const VelocityWitness<2> witness(circle(10.0, 40.0, 0.23), delayed(0.23), 0.0);
    const auto moved = witness.between(10.0, 13.0);
    ASSERT_TRUE(moved);
    EXPECT_LT((moved->displacement_m - position_at(13.0) + position_at(10.0)).norm(), 1e-4);
}

TEST(VelocityWitness, SaysNothingOfWhatItDoesNotCover) {
    std::vector<TimedVelocity<2>> samples = circle(1.0, 40.0);
    for (TimedVelocity<2>& one : samples)
        one.stretch = one.time_s > 20.0 ? 1 : 0;
    const VelocityWitness<2> witness(samples, delayed(0.5), 0.0);
    EXPECT_TRUE(witness.between(10.0, 19.0));
    // By the delay beyond its stretch; not by more.
    const auto to_the_end = witness.between(10.0, 20.0);
    ASSERT_TRUE(to_the_end);
    EXPECT_LT((to_the_end->displacement_m - position_at(20.5) + position_at(10.5)).norm(), 0.5);
    EXPECT_FALSE(witness.between(10.0, 20.1));
    EXPECT_FALSE(witness.between(19.0, 22.0));
    EXPECT_FALSE(witness.between(-1.0, 2.0));
    EXPECT_TRUE(witness.between(21.0, 39.0));
    EXPECT_TRUE(witness.between(38.0, 40.0));
    EXPECT_FALSE(witness.between(38.0, 40.1));
    const VelocityWitness<2> moving(samples, delayed(0.5), 2.0);
    EXPECT_GT(moving.between(10.0, 20.0)->covariance_m2.trace(),
              moving.between(10.0, 19.0)->covariance_m2.trace() + 2.0 * 4.0 * 0.015);
}

TEST(VelocityWitness, TheCovarianceHoldsDelayAndWhatHappensBetweenSamples) {
    VelocityErrorModel model = delayed(0.0);
    model.sigma_delay_s = 0.1;
    const VelocityWitness<2> witness(circle(1.0, 40.0), model, 2.0);
    const auto moved = witness.between(10.0, 13.0);
    ASSERT_TRUE(moved);
    const Vector2d changed = velocity_at(13.0) - velocity_at(10.0);
    const double between = 4.0 * 3.0 / 720.0;
    EXPECT_NEAR(moved->covariance_m2.trace(), 2.0 * between + 0.01 * changed.squaredNorm(), 1e-6);
}

// The bound is one: for white errors and for those that last the variance of a displacement is not
// more than the model says, whatever of the two they are.
TEST(VelocityWitness, TheErrorModelBoundsDisplacements) {
    for (const double tau_s : {0.01, 1.0, 10.0, 1000.0}) {
        double worst = 0.0;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            RandomGenerator random(seed);
            std::vector<TimedVelocity<2>> samples = circle(5.0, 1500.0);
            std::vector<TimedPosition<2>> positions;
            const double kept = std::exp(-0.2 / tau_s);
            Vector2d error(0.1 * random.normal(), 0.1 * random.normal());
            std::vector<Vector2d> errors;
            for (TimedVelocity<2>& one : samples) {
                error = kept * error + 0.1 * std::sqrt(1.0 - kept * kept) *
                                           Vector2d(random.normal(), random.normal());
                one.velocity += error;
                errors.push_back(error);
                positions.push_back({.time_s = one.time_s,
                                     .position = position_at(one.time_s) +
                                                 0.3 * Vector2d(random.normal(), random.normal()),
                                     .sigma_m = 0.3});
            }
            const VelocityWitness<2> witness(samples, delayed(0.0), 0.0);
            const VelocityErrorModel model =
                estimate_velocity_errors<2>(witness, positions, std::nullopt).model;
            ASSERT_TRUE(model.is_known());
            double squares = 0.0;
            int spans = 0;
            for (double from_s = 1.0; from_s < 1490.0; from_s += 3.0, ++spans) {
                const auto moved = witness.between(from_s, from_s + 3.0);
                squares += (moved->displacement_m - position_at(from_s + 3.0) + position_at(from_s))
                               .squaredNorm() /
                           2.0;
            }
            worst = std::max(worst, squares / spans / model.displacement_variance(3.0));
        }
        EXPECT_LT(worst, 1.2) << "correlation time " << tau_s << " s";
    }
}

TEST(VelocityWitness, AStatedAccuracyHoldsBetweenWhatTheRecordingShows) {
    VelocityErrorModel model;
    model.shown_m_s = least_velocity_sigma_m_s;
    model.density = 0.1;
    EXPECT_NEAR(std::sqrt(model.displacement_variance(3.0)), 0.1 * std::sqrt(3.0), 1e-12);
    model.stated_m_s = 0.05;
    EXPECT_NEAR(model.displacement_variance(3.0), 0.0025 * integrated_gauss_markov(3.0, 10.0),
                1e-12);
    model.stated_m_s = 5.0;  // the recording shows that they are better
    EXPECT_NEAR(std::sqrt(model.displacement_variance(3.0)), 0.1 * std::sqrt(3.0), 1e-12);
    model.stated_m_s = 0.001;  // and no velocity is that good
    EXPECT_NEAR(std::sqrt(model.displacement_variance(3.0)), 0.09, 1e-12);
    model.shown_m_s = 0.2;  // nor better than the differences show
    EXPECT_NEAR(std::sqrt(model.displacement_variance(3.0)), 0.6, 1e-12);
}

TEST(VelocityWitness, AnErrorThatLastsIsShown) {
    std::vector<TimedVelocity<2>> samples = circle(5.0, 600.0);
    std::vector<TimedPosition<2>> positions;
    for (TimedVelocity<2>& one : samples) {
        one.velocity += Vector2d(0.5, 0.0);
        positions.push_back(
            {.time_s = one.time_s, .position = position_at(one.time_s), .sigma_m = 0.02});
    }
    const VelocityWitness<2> witness(samples, delayed(0.0), 0.0);
    const VelocityErrorModel model = estimate_velocity_errors<2>(witness, positions, 0.05).model;
    EXPECT_GT(model.shown_m_s, 0.25);
    EXPECT_GE(model.displacement_variance(3.0), std::pow(0.25 * 3.0, 2));
}

TEST(VelocityWitness, TooFewSpansBoundNothing) {
    std::vector<TimedPosition<2>> positions;
    const std::vector<TimedVelocity<2>> samples = circle(5.0, 10.0);
    for (const TimedVelocity<2>& one : samples)
        positions.push_back(
            {.time_s = one.time_s, .position = position_at(one.time_s), .sigma_m = 0.02});
    const VelocityWitness<2> witness(samples, delayed(0.0), 0.0);
    EXPECT_FALSE(estimate_velocity_errors<2>(witness, positions, std::nullopt).model.is_known());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
