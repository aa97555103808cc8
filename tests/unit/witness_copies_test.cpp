#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "witness/copies.h"
#include "witness/kinds/gates.h"

// What was made from the positions, and what was measured beside them.

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;
using Rows = std::vector<TimedPosition<2>>;
using Speeds = std::vector<TimedValue>;

constexpr double kilometre_an_hour_tenth = 0.1 / 3.6;

double rounded(double value, double step) {
    return step > 0.0 ? step * std::round(value / step) : value;
}

/// A drive of 300 s on a winding course at 10 to 30 m/s.
Vector2d velocity_at(double time_s) {
    const double speed =
        20.0 + 8.0 * std::sin(2.0 * std::numbers::pi * time_s / 40.0) + 2.0 * std::sin(time_s);
    const double course = 0.8 * std::sin(time_s / 17.0);
    return speed * Vector2d(std::sin(course), std::cos(course));
}

struct Recorded {
    double rate_hz = 10.0;
    double white_m = 0.3;  ///< of each coordinate
    double slow_m = 0.0;
    double slow_s = 20.0;
    double step_m = 0.011;  ///< that positions are rounded to
    std::uint64_t seed = 1;
};

/// The positions of the drive, with their errors but unrounded.
Rows positions_of(const Recorded& recorded) {
    RandomGenerator random(recorded.seed);
    const auto pair = [&] { return Vector2d(random.normal(), random.normal()); };
    Rows rows;
    Vector2d place = Vector2d::Zero(), slow = recorded.slow_m * pair();
    const double step_s = 1.0 / recorded.rate_hz, kept = std::exp(-step_s / recorded.slow_s);
    for (int i = 0; i < 300 * recorded.rate_hz; ++i) {
        for (int part = 0; part < 20; ++part)
            place += velocity_at((i + (part + 0.5) / 20.0) * step_s) * step_s / 20.0;
        slow = kept * slow + std::sqrt(1.0 - kept * kept) * recorded.slow_m * pair();
        rows.push_back({.time_s = (i + 1) * step_s,
                        .position = place + slow + recorded.white_m * pair(),
                        .sigma_m = recorded.white_m});
    }
    return rows;
}

/// Positions rounded, as a device writes them.
Rows written(Rows rows, double step_m) {
    for (TimedPosition<2>& row : rows)
        for (double& coordinate : row.position)
            coordinate = rounded(coordinate, step_m);
    return rows;
}

Speeds measured_beside(const Rows& rows, double sigma_m_s, double delay_s, double step_m_s,
                       std::uint64_t seed = 1001) {
    RandomGenerator random(seed);
    Speeds speeds;
    for (const TimedPosition<2>& row : rows) {
        const Vector2d error(random.normal(), random.normal());
        speeds.push_back(
            {row.time_s,
             rounded((velocity_at(row.time_s - delay_s) + sigma_m_s * error).norm(), step_m_s)});
    }
    return speeds;
}

/// How positions are differenced: from the previous epoch, to the next, or between both.
enum class Difference { backward, forward, central };

/// Speeds by differences of the positions as the device has them, meaned over some epochs.
Speeds differences_of(const Rows& exact, Difference kind, int before, int after, double step_m_s) {
    Speeds speeds;
    const std::size_t ahead = kind == Difference::backward ? 0 : 1;
    const std::size_t behind = kind == Difference::forward ? 0 : 1;
    for (std::size_t i = 10; i + 10 < exact.size(); ++i) {
        Vector2d sum = Vector2d::Zero();
        for (std::size_t j = i - static_cast<std::size_t>(before);
             j <= i + static_cast<std::size_t>(after); ++j)
            sum += (exact[j + ahead].position - exact[j - behind].position) /
                   (exact[j + ahead].time_s - exact[j - behind].time_s);
        speeds.push_back({exact[i].time_s, rounded(sum.norm() / (before + after + 1), step_m_s)});
    }
    return speeds;
}

TEST(Copies, MeasuredSpeedsAreNeverTakenForDifferences) {
    for (const double rate_hz : {1.0, 5.0})
        for (const double white_m : {0.01, 0.02, 0.3, 2.0}) {
            const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m};
            const Rows rows = written(positions_of(recorded), recorded.step_m);
            for (const double sigma_m_s : {0.03, 0.1})
                for (const double delay_steps : {0.0, 0.5})
                    for (const double step_m_s : {0.0, kilometre_an_hour_tenth}) {
                        const auto speeds =
                            measured_beside(rows, sigma_m_s, delay_steps / rate_hz, step_m_s);
                        const VelocityOrigin found = made_from(speeds, rows, 0.0, recorded.step_m);
                        const auto said =
                            fmt::format("{} Hz, positions {} m, speeds {} m/s by {}, {} steps late",
                                        rate_hz, white_m, sigma_m_s, step_m_s, delay_steps);
                        EXPECT_NE(found, VelocityOrigin::positions) << said;
                        if (white_m > 0.1) {
                            EXPECT_EQ(found, VelocityOrigin::independent) << said;
                        }
                    }
        }
}

TEST(Copies, SlowErrorsDoNotMakeMeasuredSpeedsDifferences) {
    for (const double rate_hz : {1.0, 10.0})
        for (const double white_m : {0.0, 0.003, 0.05}) {
            const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m, .slow_m = 1.0};
            const Rows rows = written(positions_of(recorded), recorded.step_m);
            EXPECT_NE(made_from(measured_beside(rows, 0.05, 0.5 / rate_hz, 0.01), rows, 0.0,
                                recorded.step_m),
                      VelocityOrigin::positions)
                << rate_hz << " " << white_m;
        }
}

TEST(Copies, DifferencesAreFoundOfEveryKind) {
    const struct {
        Difference kind;
        int before, after;
    } schemes[] = {{Difference::backward, 0, 0}, {Difference::forward, 0, 0},
                   {Difference::central, 0, 0},  {Difference::backward, 1, 0},
                   {Difference::backward, 4, 0}, {Difference::central, 1, 1},
                   {Difference::central, 2, 2}};
    for (const double rate_hz : {1.0, 10.0})
        for (const double white_m : {0.3, 2.0}) {
            const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m};
            const Rows exact = positions_of(recorded), rows = written(exact, recorded.step_m);
            for (const double step_m_s : {0.01, kilometre_an_hour_tenth})
                for (const auto& [kind, before, after] : schemes) {
                    const VelocityOrigin found =
                        made_from(differences_of(exact, kind, before, after, step_m_s), rows, 0.0,
                                  recorded.step_m);
                    const auto said = fmt::format(
                        "{} Hz, {} m, {} m/s, difference {}, {} before, {} after", rate_hz, white_m,
                        step_m_s, static_cast<int>(kind), before, after);
                    // A mean over seconds of what errs by 0.3 m is not rougher than its rounding.
                    if (white_m > 1.0 || rate_hz > 1.0 || before + after < 2) {
                        EXPECT_EQ(found, VelocityOrigin::positions) << said;
                    } else {
                        EXPECT_NE(found, VelocityOrigin::independent) << said;
                    }
                }
        }
}

TEST(Copies, WhatRoundingHidesIsUnclear) {
    // Positions good to 5 mm at 1 Hz, speeds to 0.1 km/h: a difference is no worse than a speed.
    const Recorded recorded{.rate_hz = 1.0, .white_m = 0.005, .step_m = 0.001};
    const Rows exact = positions_of(recorded);
    EXPECT_EQ(made_from(differences_of(exact, Difference::central, 0, 0, kilometre_an_hour_tenth),
                        written(exact, recorded.step_m), 0.0, recorded.step_m),
              VelocityOrigin::unclear);
}

TEST(Copies, TooFewEpochsAreUnclear) {
    Rows rows = positions_of({.rate_hz = 1.0});
    const Speeds speeds = differences_of(rows, Difference::backward, 0, 0, 0.01);
    rows.resize(30);
    EXPECT_EQ(made_from(speeds, rows), VelocityOrigin::unclear);
    EXPECT_EQ(made_from(speeds, Rows{}), VelocityOrigin::unclear);
    EXPECT_EQ(made_from(Speeds{}, positions_of({})), VelocityOrigin::unclear);
}

TEST(Copies, GapsAreNotBridged) {
    const Rows rows = positions_of({.rate_hz = 5.0, .white_m = 0.5});
    const Speeds speeds = differences_of(rows, Difference::backward, 0, 0, 0.01);
    Rows gappy;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (i % 40 < 30) gappy.push_back(rows[i]);
    EXPECT_EQ(made_from(speeds, gappy), VelocityOrigin::positions);
}

/// Speeds as a weighted mean of central differences over so many rows.
Speeds smoothed_from(const Rows& rows, std::size_t either_side, bool smooth) {
    Speeds speeds;
    for (std::size_t k = either_side; k + either_side < rows.size(); ++k) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t h = smooth ? 1 : either_side; h <= either_side; ++h) {
            const double weight = static_cast<double>(h * h * (either_side + 1 - h));
            sum += weight * (rows[k + h].position - rows[k - h].position).norm() /
                   (rows[k + h].time_s - rows[k - h].time_s);
            weights += weight;
        }
        speeds.push_back({rows[k].time_s, sum / weights});
    }
    return speeds;
}

/// A craft on a curve, with white noise of the positions.
Rows on_a_curve(double noise_m, std::uint64_t seed, double first_s = 0.0) {
    RandomGenerator random(seed);
    Rows rows;
    for (int k = 0; k < 600; ++k) {
        const double t = first_s + 0.1 * k;
        rows.push_back({.time_s = t,
                        .position = {400.0 * std::sin(0.05 * t) + noise_m * random.normal(),
                                     400.0 * std::cos(0.05 * t) + noise_m * random.normal()}});
    }
    return rows;
}

TEST(Copies, SpeedsSmoothedFromThePositionsAreToldFromMeasuredOnes) {
    const Rows rows = on_a_curve(0.01, 1);
    for (const std::size_t either_side : {1U, 2U, 6U, 15U, 30U})
        for (const bool smooth : {false, true}) {
            SCOPED_TRACE(either_side);
            const Speeds made = smoothed_from(rows, either_side, smooth);
            EXPECT_EQ(made_from(made, rows), VelocityOrigin::positions);
            // Of another scale, late by what is known, and with a smooth wave added as a disguise.
            Speeds disguised = made;
            for (TimedValue& one : disguised) {
                one.value = 1.02 * one.value + 0.2 * std::sin(0.1 * one.time_s);
                one.time_s += 0.5;
            }
            EXPECT_EQ(made_from(disguised, rows, 0.5), VelocityOrigin::positions);
        }
    for (const double noise_m_s : {0.003, 0.03, 0.3}) {
        SCOPED_TRACE(noise_m_s);
        RandomGenerator random(9);
        Speeds measured;
        for (const TimedPosition<2>& row : rows)
            measured.push_back({row.time_s, 20.0 + noise_m_s * random.normal()});
        EXPECT_NE(made_from(measured, rows), VelocityOrigin::positions);
    }
}

/// These speeds along the true motion, integrated.
VelocityWitness<2> integrated(const Speeds& speeds) {
    std::vector<TimedVelocity<2>> samples;
    for (const TimedValue& one : speeds)
        samples.push_back(
            {.time_s = one.time_s, .velocity = one.value * velocity_at(one.time_s).normalized()});
    VelocityErrorModel none;
    none.density = 0.0;
    return {samples, none, 0.6};
}

/// Speeds by the slope of the cubic that fits so many rows on either side.
Speeds slopes_of(const Rows& rows, int either_side, double step_m_s) {
    Eigen::MatrixXd powers(2 * either_side + 1, 4);
    for (int j = -either_side; j <= either_side; ++j)
        powers.row(j + either_side) << 1.0, j, j * j, j * j * j;
    const Eigen::RowVectorXd weights =
        powers.householderQr()
            .solve(Eigen::MatrixXd::Identity(powers.rows(), powers.rows()))
            .row(1);
    Speeds speeds;
    for (int k = either_side; k + either_side < static_cast<int>(rows.size()); ++k) {
        Vector2d slope = Vector2d::Zero();
        for (int j = -either_side; j <= either_side; ++j)
            slope += weights[j + either_side] / (rows[1].time_s - rows[0].time_s) *
                     rows[static_cast<std::size_t>(k + j)].position;
        speeds.push_back(
            {rows[static_cast<std::size_t>(k)].time_s, rounded(slope.norm(), step_m_s)});
    }
    return speeds;
}

// The regression cannot see through the rounding of speeds smoothed over seconds.
TEST(Copies, SmoothedSpeedsThatAreRoundedKeepToThePositions) {
    const Rows rows =
        positions_of({.white_m = 0.004, .slow_m = 0.005, .slow_s = 10.0, .step_m = 0.0});
    for (const double step_m_s : {0.0, 0.01, kilometre_an_hour_tenth}) {
        const Speeds made = slopes_of(rows, 8, step_m_s);
        EXPECT_TRUE(made_from(made, rows) == VelocityOrigin::positions ||
                    made_from(integrated(made), step_m_s / std::sqrt(12.0), 0.1, rows))
            << step_m_s;
    }
    for (const double sigma_m_s : {0.02, 0.05})
        EXPECT_FALSE(
            made_from(integrated(measured_beside(rows, sigma_m_s, 0.0, 0.01)), 0.003, 0.1, rows));
}

// It departs from them by less than any measured speeds were seen to do, by the positions' errors.
TEST(Copies, AnExactWheelBesideWanderingPositionsIsNone) {
    for (const double white_m : {0.001, 0.004})
        for (const double slow_s : {10.0, 20.0})
            for (const std::uint64_t seed : {1U, 2U, 3U}) {
                SCOPED_TRACE(fmt::format("{} {} {}", white_m, slow_s, seed));
                const Rows rows = positions_of({.white_m = white_m,
                                                .slow_m = 0.005,
                                                .slow_s = slow_s,
                                                .step_m = 0.0,
                                                .seed = seed});
                const Speeds exact = measured_beside(rows, 0.0, 0.0, 0.0);
                EXPECT_NE(made_from(exact, rows), VelocityOrigin::positions);
                EXPECT_FALSE(made_from(integrated(exact), 0.0, 0.1, rows));
            }
}

// Positions that are integrated speeds, straight ahead: the other axis has no errors at all.
TEST(Copies, SpeedsAreFoundInTheirIntegral) {
    RandomGenerator random(1);
    Rows rows;
    Speeds others, copies;
    Vector2d place = Vector2d::Zero();
    for (int k = 0; k < 1200; ++k) {
        const double true_m_s = 30.0 + 5.0 * std::sin(0.02 * k);
        const double speed_m_s = true_m_s + 0.03 * random.normal();
        place.y() += 0.1 * speed_m_s;
        rows.push_back({.time_s = 0.1 * k, .position = place});
        copies.push_back({0.1 * k, rounded(speed_m_s / 1.02, 1e-4)});
        others.push_back({0.1 * k, true_m_s + 0.02 * random.normal()});
    }
    EXPECT_EQ(made_from(copies, rows), VelocityOrigin::positions);
    EXPECT_EQ(made_from(others, rows), VelocityOrigin::independent);
}

TEST(Copies, TheStepOfWrittenSpeedsIsSeen) {
    Speeds speeds;
    for (int k = 0; k < 200; ++k)
        speeds.push_back({0.1 * k, kilometre_an_hour_tenth * (k * 7 % 200)});
    EXPECT_NEAR(resolution_m_s(speeds), kilometre_an_hour_tenth, 1e-6);
    for (TimedValue& one : speeds)
        one.value = 0.001 * std::round(20.0 * one.time_s * one.time_s);
    EXPECT_EQ(resolution_m_s(speeds), 0.01);
    EXPECT_NEAR(resolution_m_s(speeds, 0.0), 0.001, 1e-6);
    for (TimedValue& one : speeds)
        one.value = std::sin(one.time_s);
    EXPECT_EQ(resolution_m_s(speeds, 0.0), 0.0);
    EXPECT_EQ(resolution_m_s({}), 0.01);
}

Rows changed(Rows rows, const std::function<Vector2d(const TimedPosition<2>&)>& change) {
    for (TimedPosition<2>& row : rows)
        row.position = change(row);
    return rows;
}

TEST(Copies, TwoReceiversHaveErrorsOfTheirOwn) {
    const Rows first = on_a_curve(0.01, 1);
    // A better receiver, a worse one, and one at other instants.
    EXPECT_FALSE(made_from(on_a_curve(0.01, 2), first, 0.0));
    EXPECT_FALSE(made_from(on_a_curve(0.003, 3), first, 0.0));
    EXPECT_FALSE(made_from(on_a_curve(0.05, 4), first, 0.0));
    EXPECT_FALSE(made_from(on_a_curve(0.01, 5, 0.05), first, 0.0));
    EXPECT_FALSE(made_from(Rows{}, first, 0.0));
}

TEST(Copies, ACopiedReceiverHasTheErrorsOfTheFirst) {
    const Rows first = on_a_curve(0.01, 1);
    EXPECT_TRUE(made_from(first, first, 0.0));
    const auto moved = [&](auto change) { return made_from(changed(first, change), first, 0.0); };
    // Shifted, with another antenna's sway, rounded, stretched a little.
    EXPECT_TRUE(
        moved([](const auto& row) -> Vector2d { return row.position + Vector2d(0.4, -0.7); }));
    EXPECT_TRUE(moved([](const auto& row) -> Vector2d {
        return row.position + 0.5 * Vector2d(std::sin(0.1 * row.time_s), 0.3);
    }));
    EXPECT_TRUE(moved([](const auto& row) -> Vector2d {
        return (row.position * 1000.0).array().round() / 1000.0;
    }));
    EXPECT_TRUE(moved([](const auto& row) -> Vector2d { return 1.0005 * row.position; }));
    // The same on another clock.
    Rows later = first;
    for (TimedPosition<2>& row : later)
        row.time_s -= 7.0;
    EXPECT_TRUE(made_from(later, first, 7.0));
    // Every second one, and smoothed ones, either way.
    Rows thinned, smoothed = first;
    for (std::size_t i = 0; i < first.size(); i += 2)
        thinned.push_back(first[i]);
    for (std::size_t i = 2; i + 2 < first.size(); ++i)
        smoothed[i].position = (first[i - 2].position + first[i - 1].position + first[i].position +
                                first[i + 1].position + first[i + 2].position) /
                               5.0;
    for (const Rows& copy : {thinned, smoothed}) {
        EXPECT_TRUE(made_from(copy, first, 0.0));
        EXPECT_TRUE(made_from(first, copy, 0.0));
    }
}

TEST(Copies, ACopyBetweenTheInstantsIsFound) {
    const Rows first = on_a_curve(0.01, 1);
    Rows between;
    for (std::size_t i = 1; i < first.size(); ++i)
        between.push_back({.time_s = 0.5 * (first[i - 1].time_s + first[i].time_s),
                           .position = 0.5 * (first[i - 1].position + first[i].position)});
    EXPECT_TRUE(made_from(between, first, 0.0));
}

/// Gates every 60 m, passed at 60 m/s, with these errors of their distances.
GateWitness gates(const std::vector<double>& errors_m) {
    std::vector<GatePassage> passages;
    for (std::size_t i = 0; i < errors_m.size(); ++i) {
        const auto at = static_cast<double>(i);
        passages.push_back({.time_s = at,
                            .distance_m = 60.0 * at + errors_m[i],
                            .position_m = {60.0 * at, 0.0},
                            .speed_m_s = 60.0});
    }
    return {passages, {.sigma_distance_m = 0.005, .sigma_time_s = 0.0001}};
}

TEST(Copies, GatesThatAgreeBetterThanTheyClaimWereMadeFromThePositions) {
    EXPECT_TRUE(gates({0.0, 0.0}).agrees_too_well());
    EXPECT_TRUE(gates({0.0, 0.0005, -0.0005, 0.0005, 0.0}).agrees_too_well());
    EXPECT_FALSE(gates({0.0, 0.012}).agrees_too_well());
    EXPECT_FALSE(gates({0.0, 0.009, -0.004, 0.011, 0.002}).agrees_too_well());
    EXPECT_FALSE(gates({0.0}).agrees_too_well());
}

// A simulated run at a constant speed, without any error.
TEST(MadeFrom, TellsNothingOfAnExactlySteadyMotion) {
    Rows rows;
    Speeds speeds;
    for (int i = 0; i < 400; ++i) {
        rows.push_back({.time_s = 0.2 * i, .position = Vector2d(0.0, 2.0 * i)});
        speeds.push_back({.time_s = 0.2 * i, .value = 10.0});
    }
    EXPECT_NE(made_from(speeds, rows), VelocityOrigin::positions);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
