#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "core/statistics.h"
#include "motion/speed_mixture.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Of 20 mm fixed positions over 3 s, and velocities of 0.05 m/s.
constexpr double p = 0.0213, w = 0.030;
constexpr double largest = 0.97;

SpeedBySource positions_at(double speed_m_s, double fault = 0.002, double largest_m_s = largest) {
    return {.speed_m_s = speed_m_s,
            .standard_uncertainty_m_s = p,
            .fault = {.probability = fault, .largest_m_s = largest_m_s}};
}
SpeedBySource witness_at(double speed_m_s) {
    return {.speed_m_s = speed_m_s,
            .standard_uncertainty_m_s = w,
            .fault = {.probability = 0.01, .largest_m_s = 1.0}};
}

/// In closed form: G is the integral of the normal distribution.
double alone_in_closed_form(double below_m_s, double fault, double largest_m_s) {
    const auto g = [](double x) {
        return x * normal_cdf(x) + std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    };
    const double z = below_m_s / p, a = largest_m_s / p;
    return (1.0 - fault) * normal_cdf(z) + fault * (g(z + a) - g(z - a)) / (2.0 * a);
}

TEST(SpeedMixture, OfPositionsAloneIsItsClosedForm) {
    for (const double fault : {0.0, 0.002, 0.05})
        for (const double largest_m_s : {0.01, 0.3, 0.97, 20.0})
            for (const double below_m_s : {-0.2, -0.05, 0.0, 0.05, 0.3, 0.9}) {
                const SpeedMixture mixture(positions_at(60.0, fault, largest_m_s), std::nullopt);
                EXPECT_NEAR(mixture.probability_not_below(60.0 - below_m_s),
                            alone_in_closed_form(below_m_s, fault, largest_m_s), 2e-6);
                EXPECT_NEAR(mixture.probability_below(60.0 - below_m_s),
                            1.0 - alone_in_closed_form(below_m_s, fault, largest_m_s), 2e-6);
            }
}

TEST(SpeedMixture, TellsWhatIsUnderTheSpeedWithASmallRisk) {
    // The published figures, km/h under the stated speed, at a difference of 0: COMBINATION.
    const auto under = [](const std::optional<SpeedBySource>& witness, double risk) {
        return 3.6 * (60.0 - SpeedMixture(positions_at(60.0), witness).quantile(risk));
    };
    EXPECT_NEAR(under(std::nullopt, 1e-3), 0.29, 0.03);
    EXPECT_NEAR(under(std::nullopt, 1e-4), 3.14, 0.1);
    EXPECT_NEAR(under(witness_at(60.0), 1e-3), 0.19, 0.05);
    EXPECT_NEAR(under(witness_at(60.0), 1e-4), 0.23, 0.05);
}

TEST(SpeedMixture, HalfItsWidthHoldsTheProbability) {
    EXPECT_NEAR(SpeedMixture(positions_at(60.0, 0.0), std::nullopt).half_width(60.0, 0.9545),
                2.0 * p, 1e-5);
    for (const double other_m_s : {60.0, 59.9, 59.7, 60.2}) {
        const SpeedMixture mixture(positions_at(60.0), witness_at(other_m_s));
        for (const double about_m_s : {60.0, 59.8}) {
            const double half = mixture.half_width(about_m_s, 0.9545);
            EXPECT_NEAR(1.0 - mixture.probability_below(about_m_s - half) -
                            mixture.probability_not_below(about_m_s + half),
                        0.9545, 1e-9);
        }
    }
    // As likely at fault as not: nine tenths of the largest fault.
    EXPECT_NEAR(SpeedMixture(positions_at(60.0, 0.5), std::nullopt).half_width(60.0, 0.9545),
                0.909 * largest, 1e-3);
}

TEST(SpeedMixture, WhoIsAtFaultIsToldByTheDifference) {
    EXPECT_DOUBLE_EQ(SpeedMixture(positions_at(60.0), std::nullopt).positions_at_fault(), 0.002);
    const SpeedMixture agree(positions_at(60.0), witness_at(60.0));
    EXPECT_NEAR(agree.positions_at_fault(), 9.5e-5, 2e-5);
    EXPECT_LT(agree.witness_at_fault(), 1e-3);
    const SpeedMixture apart(positions_at(60.0), witness_at(59.7));
    EXPECT_GT(apart.positions_at_fault() + apart.witness_at_fault(), 0.999);
    // Five times as often the witness.
    EXPECT_NEAR(apart.witness_at_fault() / apart.positions_at_fault(), 0.01 / 0.002 * largest, 0.1);
    // Paths err upwards alone: positions that are slower are not at fault.
    SpeedBySource path = positions_at(59.7);
    path.fault.upwards_alone = true;
    EXPECT_LT(SpeedMixture(path, witness_at(60.0)).positions_at_fault(), 1e-6);
    // Such a difference nothing explains.
    EXPECT_EQ(SpeedMixture(positions_at(60.0), witness_at(10.0)).positions_at_fault(), 1.0);
}

TEST(SpeedMixture, ATruthfulWitnessNeverLowersTheProbabilityOnAverage) {
    // Of a record that is beaten, by the faults' own prior.
    RandomGenerator random(3);
    double alone = 0.0, beside = 0.0, below_alone = 0.0, below_beside = 0.0;
    constexpr int runs = 40'000;
    int held = 0;
    for (int k = 0; k < runs; ++k) {
        const double truth = 60.0 + 2.0 * p;
        const double fault =
            random.uniform() < 0.05 ? largest * (2.0 * random.uniform() - 1.0) : 0.0;
        const auto positions = positions_at(truth + fault + p * random.normal(), 0.05);
        const auto witness =
            witness_at(truth + w * random.normal() +
                       (random.uniform() < 0.01 ? 2.0 * random.uniform() - 1.0 : 0.0));
        const SpeedMixture one(positions, std::nullopt), both(positions, witness);
        alone += one.probability_not_below(60.0) / runs;
        beside += both.probability_not_below(60.0) / runs;
        below_alone += one.probability_below(60.0) / runs;
        below_beside += both.probability_below(60.0) / runs;
        const double of_truth = both.probability_below(truth);
        held += of_truth > 0.025 && of_truth < 0.975 ? 1 : 0;
    }
    EXPECT_GT(beside, alone + 0.005);
    EXPECT_LT(below_beside, below_alone);
    EXPECT_NEAR(static_cast<double>(held) / runs, 0.95, 0.005);
}

TEST(SpeedMixture, WhatBothShareTheDifferenceDoesNotShow) {
    const SpeedMixture without(positions_at(60.0), witness_at(60.0));
    const SpeedMixture with(positions_at(60.0), witness_at(60.0), 0.2);
    EXPECT_DOUBLE_EQ(with.positions_at_fault(), without.positions_at_fault());
    EXPECT_LT(with.probability_not_below(59.8), without.probability_not_below(59.8));
    EXPECT_NEAR(with.probability_not_below(59.8), normal_cdf(0.2 / std::hypot(0.2, 0.0195)), 0.01);
    EXPECT_NEAR(with.probability_not_below(59.8, 0.3),
                normal_cdf(0.2 / std::hypot(0.2, 0.3, 0.0195)), 0.01);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
