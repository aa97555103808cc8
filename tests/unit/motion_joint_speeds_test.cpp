#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "core/statistics.h"
#include "motion/joint_speeds.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Of 20 mm fixed positions over 3 s, and velocities of 0.05 m/s.
constexpr double p = 0.0213, w = 0.030;
constexpr double largest = 0.97;

SpeedBySource positions_at(double speed_m_s, double fault = 0.002, double largest_m_s = largest) {
    return {.speed_m_s = speed_m_s,
            .own_m_s = p,
            .fault = {.probability = fault, .largest_m_s = largest_m_s}};
}
SpeedBySource witness_at(double speed_m_s) {
    return {
        .speed_m_s = speed_m_s, .own_m_s = w, .fault = {.probability = 0.01, .largest_m_s = 1.0}};
}

SpeedMixture mixture_by(const SpeedBySource& positions) {
    return SpeedMixture(std::array{positions});
}
SpeedMixture mixture_by(const SpeedBySource& positions, const SpeedBySource& witness,
                        double common_m_s = 0.0) {
    return SpeedMixture(std::array{positions, witness}, common_m_s);
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
                const SpeedMixture mixture = mixture_by(positions_at(60.0, fault, largest_m_s));
                EXPECT_NEAR(mixture.probability_not_below(60.0 - below_m_s),
                            alone_in_closed_form(below_m_s, fault, largest_m_s), 2e-6);
                EXPECT_NEAR(mixture.probability_below(60.0 - below_m_s),
                            1.0 - alone_in_closed_form(below_m_s, fault, largest_m_s), 2e-6);
            }
}

TEST(SpeedMixture, TellsWhatIsUnderTheSpeedWithASmallRisk) {
    // The published figures, km/h under the stated speed, at a difference of 0: COMBINATION.
    const auto under = [](const SpeedMixture& mixture, double risk) {
        return 3.6 * (60.0 - mixture.quantile(risk));
    };
    const SpeedMixture alone = mixture_by(positions_at(60.0));
    const SpeedMixture beside = mixture_by(positions_at(60.0), witness_at(60.0));
    EXPECT_NEAR(under(alone, 1e-3), 0.29, 0.03);
    EXPECT_NEAR(under(alone, 1e-4), 3.14, 0.1);
    EXPECT_NEAR(under(beside, 1e-3), 0.19, 0.05);
    EXPECT_NEAR(under(beside, 1e-4), 0.23, 0.05);
}

TEST(SpeedMixture, HalfItsWidthHoldsTheProbability) {
    EXPECT_NEAR(mixture_by(positions_at(60.0, 0.0)).half_width(60.0, 0.9545), 2.0 * p, 1e-5);
    for (const double other_m_s : {60.0, 59.9, 59.7, 60.2}) {
        const SpeedMixture mixture = mixture_by(positions_at(60.0), witness_at(other_m_s));
        for (const double about_m_s : {60.0, 59.8}) {
            const double half = mixture.half_width(about_m_s, 0.9545);
            EXPECT_NEAR(1.0 - mixture.probability_below(about_m_s - half) -
                            mixture.probability_not_below(about_m_s + half),
                        0.9545, 1e-9);
        }
    }
    // As likely at fault as not: nine tenths of the largest fault.
    EXPECT_NEAR(mixture_by(positions_at(60.0, 0.5)).half_width(60.0, 0.9545), 0.909 * largest,
                1e-3);
}

TEST(FaultPosteriors, AreToldByTheDifference) {
    const auto faults = [](const SpeedBySource& positions, const SpeedBySource& witness) {
        return fault_posteriors(std::array{positions, witness});
    };
    EXPECT_DOUBLE_EQ(fault_posteriors(std::array{positions_at(60.0)})[0], 0.002);
    const auto agree = faults(positions_at(60.0), witness_at(60.0));
    EXPECT_NEAR(agree[0], 9.5e-5, 2e-5);
    EXPECT_LT(agree[1], 1e-3);
    const auto apart = faults(positions_at(60.0), witness_at(59.7));
    EXPECT_GT(apart[0] + apart[1], 0.999);
    // Five times as often the witness.
    EXPECT_NEAR(apart[1] / apart[0], 0.01 / 0.002 * largest, 0.1);
    // Paths err upwards alone: positions that are slower are not at fault.
    SpeedBySource path = positions_at(59.7);
    path.fault.upwards_alone = true;
    EXPECT_LT(faults(path, witness_at(60.0))[0], 1e-6);
    // Such a difference nothing explains.
    EXPECT_EQ(faults(positions_at(60.0), witness_at(10.0))[0], 1.0);
    EXPECT_EQ(mixture_by(positions_at(60.0), witness_at(10.0)).half_width(60.0, 0.9545),
              mixture_by(positions_at(60.0)).half_width(60.0, 0.9545));
}

// Of two witnesses that agree with one another, neither is off by what the positions are.
TEST(FaultPosteriors, OfThreeSourcesNameTheOneThatIsApart) {
    const auto of = [](double positions_m_s, double first_m_s, double second_m_s) {
        return fault_posteriors(
            std::array{positions_at(positions_m_s), witness_at(first_m_s), witness_at(second_m_s)});
    };
    EXPECT_GT(of(60.3, 60.0, 60.0)[0], 0.99);
    EXPECT_GT(of(60.0, 60.3, 60.0)[1], 0.99);
    EXPECT_GT(of(60.0, 60.0, 60.3)[2], 0.99);
    // Then the others make the speed.
    const SpeedMixture mixture(std::array{positions_at(60.3), witness_at(60.0), witness_at(60.02)});
    EXPECT_NEAR(mixture.quantile(0.5), 60.01, 0.01);
    const SpeedMixture of_others(
        std::array{positions_at(60.0), witness_at(60.3), witness_at(60.01)});
    const double k = p * p / (p * p + w * w);
    EXPECT_NEAR(of_others.quantile(0.5), 60.0 + k * 0.01, 0.001);
}

/// The distribution by brute force: the sum over a grid of true speeds and faults.
double below_by_sum(const std::array<SpeedBySource, 3>& speeds, double speed_m_s) {
    double below = 0.0, all = 0.0;
    constexpr double step_m_s = 0.004;
    const auto add = [&](int at_fault, double prior, double fault_m_s) {
        for (double v = 59.0 + 0.5 * step_m_s; v < 61.0; v += step_m_s) {
            double log = 0.0;
            for (int i = 0; i < 3; ++i) {
                const SpeedBySource& one = speeds[static_cast<std::size_t>(i)];
                const double off = one.speed_m_s - v - (i == at_fault ? fault_m_s : 0.0);
                log -= 0.5 * off * off / (one.own_m_s * one.own_m_s);
            }
            all += prior * std::exp(log);
            below += prior * std::exp(log) * std::clamp((speed_m_s - v) / step_m_s + 0.5, 0.0, 1.0);
        }
    };
    for (int j = -1; j < 3; ++j) {
        double prior = 1.0;
        for (int i = 0; i < 3; ++i) {
            const double one = speeds[static_cast<std::size_t>(i)].fault.probability;
            prior *= i == j ? one : 1.0 - one;
        }
        if (j < 0) {
            add(j, prior, 0.0);
            continue;
        }
        const double size = speeds[static_cast<std::size_t>(j)].fault.largest_m_s;
        const int parts = static_cast<int>(2.0 * size / step_m_s);
        for (int k = 0; k < parts; ++k)
            add(j, prior / parts, -size + (k + 0.5) * 2.0 * size / parts);
    }
    return below / all;
}

TEST(SpeedMixture, OfThreeSourcesIsTheSumOverAllThatMayBe) {
    for (const double positions_m_s : {60.0, 60.08, 60.15})
        for (const double second_m_s : {60.0, 59.93}) {
            const std::array speeds{positions_at(positions_m_s, 0.05), witness_at(60.0),
                                    witness_at(second_m_s)};
            const SpeedMixture mixture(speeds);
            for (const double at_m_s : {59.95, 60.0, 60.05})
                EXPECT_NEAR(mixture.probability_below(at_m_s), below_by_sum(speeds, at_m_s), 5e-3);
        }
}

TEST(MeanSpeeds, MakeTheLeastVariance) {
    const std::array speeds{
        SpeedBySource{.speed_m_s = 60.0, .own_m_s = std::hypot(0.02, 0.03), .slow_m_s = 0.01},
        SpeedBySource{.speed_m_s = 59.98, .own_m_s = 0.03},
        SpeedBySource{.speed_m_s = 60.01, .own_m_s = 0.004, .slow_m_s = 0.005},
        SpeedBySource{.speed_m_s = 59.97, .own_m_s = 0.02, .slow_m_s = 0.01}};
    const MeanSpeed mean = mean_of(speeds);
    double sum = 0.0, speed_m_s = 0.0;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        EXPECT_GE(mean.weights[i], 0.0);
        sum += mean.weights[i];
        speed_m_s += mean.weights[i] * speeds[i].speed_m_s;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_NEAR(mean.speed_m_s, speed_m_s, 1e-12);
    // By draws of the errors, those that are shared once: no other weights do better.
    const auto variance = [&](const std::vector<double>& weights) {
        RandomGenerator draws(7);
        double square = 0.0;
        constexpr int count = 20'000;
        for (int k = 0; k < count; ++k) {
            const double shared = 0.005 * draws.normal();
            const double slow = shared + std::sqrt(1e-4 - 0.005 * 0.005) * draws.normal();
            double error = (weights[0] + weights[3]) * slow + weights[2] * shared;
            for (std::size_t i = 0; i < speeds.size(); ++i)
                error += weights[i] * speeds[i].own_m_s * draws.normal();
            square += error * error / count;
        }
        return square;
    };
    const double least = variance(mean.weights);
    EXPECT_NEAR(std::sqrt(least), mean.standard_uncertainty_m_s,
                0.02 * mean.standard_uncertainty_m_s);
    RandomGenerator random(5);
    for (std::size_t other = 0; other < 20; ++other) {
        std::vector<double> moved = mean.weights;
        const double by = 0.1 * (random.uniform() - 0.5);
        moved[other % 4] += by;
        moved[(other + 1) % 4] -= by;
        EXPECT_GT(variance(moved), 0.995 * least);
    }
    // A rare fault of the first moves weight to the others.
    EXPECT_LT(mean_of(speeds, 0.1).weights[0], mean.weights[0]);
}

TEST(MeanSpeeds, HaveNoNegativeWeights) {
    RandomGenerator random(9);
    for (int k = 0; k < 1000; ++k) {
        std::vector<SpeedBySource> speeds;
        for (int i = 0; i < 4; ++i)
            speeds.push_back({.own_m_s = std::pow(10.0, -4.0 * random.uniform()),
                              .slow_m_s = std::pow(10.0, -4.0 * random.uniform())});
        const MeanSpeed mean = mean_of(speeds);
        double least = 1e9;
        for (std::size_t i = 0; i < speeds.size(); ++i) {
            EXPECT_GE(mean.weights[i], 0.0);
            least = std::min(least, std::hypot(speeds[i].own_m_s, speeds[i].slow_m_s));
        }
        EXPECT_LE(mean.standard_uncertainty_m_s, least * (1.0 + 1e-9));
        EXPECT_LE(mean.slow_m_s, mean.standard_uncertainty_m_s);
    }
}

// A wheel whose scale was fitted to other runs confirmed positions that drifted in all of them.
TEST(ASourceCalibratedByTheFirst, HasItsFaultAndConfirmsNothingOfIt) {
    SpeedBySource wheel = witness_at(60.0);
    wheel.fault_is_common = true;
    const std::array alone{positions_at(60.0)};
    const std::array speeds{positions_at(60.0), wheel};
    const MeanSpeed mean = mean_of(speeds, 0.1);
    EXPECT_DOUBLE_EQ(mean.fault_share, 1.0);
    EXPECT_NEAR(mean.standard_uncertainty_m_s,
                std::hypot(0.1, mean_of(speeds).standard_uncertainty_m_s), 1e-9);
    EXPECT_LE(fault_posteriors(speeds)[0], fault_posteriors(alone)[0] * (1.0 + 1e-9));
    EXPECT_NEAR(SpeedMixture(speeds).quantile(1e-4), SpeedMixture(alone).quantile(1e-4), 0.05);
    // Beside another witness neither is believed the more.
    const auto three = [&](const SpeedBySource& second) {
        return fault_posteriors(std::array{positions_at(60.3), second, witness_at(60.0)});
    };
    SpeedBySource off = witness_at(60.3);
    off.fault_is_common = true;
    EXPECT_NEAR(three(off)[0] / three(off)[2], 0.002 / 0.01 / largest, 0.05);
    EXPECT_LT(three(witness_at(60.3))[0], 1e-4);
    // Weights that would be negative are none.
    const MeanSpeed held =
        mean_of(std::array{SpeedBySource{.own_m_s = 0.001, .slow_m_s = 0.1},
                           SpeedBySource{.own_m_s = 0.01, .slow_m_s = 0.1},
                           SpeedBySource{.own_m_s = 0.01, .fault_is_common = true}},
                0.1);
    double sum = 0.0;
    for (const double weight : held.weights) {
        EXPECT_GE(weight, 0.0);
        sum += weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(Disagreement, IsThatOfAllTogether) {
    const SpeedBySource positions{.own_m_s = 0.03, .slow_m_s = 0.04, .fault = {0.5, 9.0}};
    EXPECT_EQ(disagreement(std::array{positions}), 0.0);
    // Of one: its difference in standard deviations over 3.29.
    const auto witness = [](double speed_m_s) {
        return SpeedBySource{.speed_m_s = speed_m_s, .own_m_s = 0.12};
    };
    EXPECT_NEAR(disagreement(std::array{positions, witness(0.2)}), 0.2 / 0.13 / 3.2905, 1e-4);
    // Two to opposite sides are further apart than either is.
    EXPECT_GT(disagreement(std::array{positions, witness(0.35), witness(-0.35)}), 1.0);
    EXPECT_LT(disagreement(std::array{positions, witness(0.35)}), 0.85);
    // Another receiver's time-correlated error may be another one; that of phases is not.
    const auto beside = [&](bool slow_differs) {
        return disagreement(std::array{positions, SpeedBySource{.speed_m_s = 0.2,
                                                                .own_m_s = 0.03,
                                                                .slow_m_s = 0.04,
                                                                .slow_differs = slow_differs}});
    };
    EXPECT_NEAR(beside(true), 0.2 / std::hypot(0.05, 0.05) / 3.2905, 1e-4);
    EXPECT_NEAR(beside(false), 0.2 / std::hypot(0.05, 0.03) / 3.2905, 1e-4);
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
        const SpeedMixture one = mixture_by(positions), both = mixture_by(positions, witness);
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
    const SpeedMixture without = mixture_by(positions_at(60.0), witness_at(60.0));
    const SpeedMixture with = mixture_by(positions_at(60.0), witness_at(60.0), 0.2);
    EXPECT_LT(with.probability_not_below(59.8), without.probability_not_below(59.8));
    EXPECT_NEAR(with.probability_not_below(59.8), normal_cdf(0.2 / std::hypot(0.2, 0.0195)), 0.01);
    EXPECT_NEAR(with.probability_not_below(59.8, 0.3),
                normal_cdf(0.2 / std::hypot(0.2, 0.3, 0.0195)), 0.01);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
