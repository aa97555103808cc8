#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "witness/velocity_origin.h"

// Speeds that a device measured, and those that it computed from its positions.

namespace runcert::RUNCERT_FILE {
namespace {

using velocities::Difference;
using velocities::Origin;
using velocities::SpeedBesidePosition;
using Rows = std::vector<SpeedBesidePosition>;

constexpr double kilometre_an_hour_tenth = 0.1 / 3.6;

double rounded(double value, double step) {
    return step > 0.0 ? step * std::round(value / step) : value;
}

/// A drive of 300 s on a winding course at 10 to 30 m/s.
Eigen::Vector2d velocity_at(double time_s) {
    const double speed =
        20.0 + 8.0 * std::sin(2.0 * std::numbers::pi * time_s / 40.0) + 2.0 * std::sin(time_s);
    const double course = 0.8 * std::sin(time_s / 17.0);
    return speed * Eigen::Vector2d(std::sin(course), std::cos(course));
}

struct Recorded {
    double rate_hz = 10.0;
    double white_m = 0.3;   ///< of each coordinate
    double slow_m = 0.0;    ///< with a time of 20 s
    double step_m = 0.011;  ///< that positions are rounded to
    std::uint64_t seed = 1;
};

/// The positions of the drive, with their errors but unrounded.
Rows positions_of(const Recorded& recorded) {
    RandomGenerator random(recorded.seed);
    Rows rows;
    Eigen::Vector2d place = Eigen::Vector2d::Zero(), slow = Eigen::Vector2d::Zero();
    const auto pair = [&] { return Eigen::Vector2d(random.normal(), random.normal()); };
    const double step_s = 1.0 / recorded.rate_hz, kept = std::exp(-step_s / 20.0);
    for (int i = 0; i < 300 * recorded.rate_hz; ++i) {
        for (int part = 0; part < 20; ++part)
            place += velocity_at((i + (part + 0.5) / 20.0) * step_s) * step_s / 20.0;
        slow = kept * slow + std::sqrt(1.0 - kept * kept) * recorded.slow_m * pair();
        rows.push_back({(i + 1) * step_s, place + slow + recorded.white_m * pair(), std::nullopt});
    }
    return rows;
}

/// The rows with positions rounded, as a device writes them.
Rows written(Rows rows, double step_m) {
    for (SpeedBesidePosition& row : rows)
        for (double& coordinate : row.position_m)
            coordinate = rounded(coordinate, step_m);
    return rows;
}

Rows with_measured_speeds(const Recorded& recorded, double sigma_m_s, double delay_s,
                          double step_m_s) {
    Rows rows = written(positions_of(recorded), recorded.step_m);
    RandomGenerator random(recorded.seed + 1000);
    for (SpeedBesidePosition& row : rows) {
        const Eigen::Vector2d error(random.normal(), random.normal());
        row.speed_m_s =
            rounded((velocity_at(row.time_s - delay_s) + sigma_m_s * error).norm(), step_m_s);
    }
    return rows;
}

/// Speeds by differences of the positions as the device has them, meaned over some epochs.
Rows with_computed_speeds(const Recorded& recorded, Difference kind, int before, int after,
                          double step_m_s) {
    const Rows exact = positions_of(recorded);
    Rows rows = written(exact, recorded.step_m);
    const std::size_t ahead = kind == Difference::backward ? 0 : 1;
    const std::size_t behind = kind == Difference::forward ? 0 : 1;
    for (std::size_t i = 10; i + 10 < rows.size(); ++i) {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (std::size_t j = i - static_cast<std::size_t>(before);
             j <= i + static_cast<std::size_t>(after); ++j)
            sum += (exact[j + ahead].position_m - exact[j - behind].position_m) /
                   (exact[j + ahead].time_s - exact[j - behind].time_s);
        rows[i].speed_m_s = rounded(sum.norm() / (before + after + 1), step_m_s);
    }
    return rows;
}

TEST(VelocityOrigin, MeasuredSpeedsAreNeverTakenForDifferences) {
    for (const double rate_hz : {1.0, 5.0, 10.0})
        for (const double white_m : {0.02, 0.3, 2.0})
            for (const double sigma_m_s : {0.03, 0.1})
                for (const double delay_steps : {0.0, 0.5, 1.0})
                    for (const double step_m_s : {0.001, 0.01, kilometre_an_hour_tenth}) {
                        const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m};
                        const Rows rows = with_measured_speeds(recorded, sigma_m_s,
                                                               delay_steps / rate_hz, step_m_s);
                        const auto found = velocities::origin_of_speeds(rows, recorded.step_m);
                        EXPECT_NE(found.origin, Origin::positions)
                            << rate_hz << " Hz, positions " << white_m << " m, speeds " << sigma_m_s
                            << " m/s by " << step_m_s << ", " << delay_steps
                            << " steps late: " << found.residual_m_s << " of " << found.noise_m_s;
                        if (white_m > 0.1) {
                            EXPECT_EQ(found.origin, Origin::independent) << rate_hz << white_m;
                        }
                    }
}

TEST(VelocityOrigin, SlowErrorsDoNotMakeMeasuredSpeedsDifferences) {
    for (const double rate_hz : {1.0, 10.0})
        for (const double white_m : {0.0, 0.003, 0.05}) {
            const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m, .slow_m = 1.0};
            const Rows rows = with_measured_speeds(recorded, 0.05, 0.5 / rate_hz, 0.01);
            EXPECT_NE(velocities::origin_of_speeds(rows, recorded.step_m).origin, Origin::positions)
                << rate_hz << " " << white_m;
        }
}

TEST(VelocityOrigin, DifferencesAreFoundOfEveryKind) {
    const struct {
        Difference kind;
        int before, after;
    } schemes[] = {{Difference::backward, 0, 0}, {Difference::forward, 0, 0},
                   {Difference::central, 0, 0},  {Difference::backward, 1, 0},
                   {Difference::backward, 4, 0}, {Difference::central, 1, 1},
                   {Difference::central, 2, 2}};
    for (const double rate_hz : {1.0, 10.0})
        for (const double white_m : {0.3, 2.0})
            for (const double step_m_s : {0.01, kilometre_an_hour_tenth})
                for (const auto& [kind, before, after] : schemes) {
                    const Recorded recorded{.rate_hz = rate_hz, .white_m = white_m};
                    const Rows rows = with_computed_speeds(recorded, kind, before, after, step_m_s);
                    const auto found = velocities::origin_of_speeds(rows, recorded.step_m);
                    const auto said = fmt::format(
                        "{} Hz, {} m, {} m/s, difference {}, {} before, {} after: {} of {}",
                        rate_hz, white_m, step_m_s, static_cast<int>(kind), before, after,
                        found.residual_m_s, found.noise_m_s);
                    // A mean over seconds of what errs by 0.3 m is not rougher than its rounding.
                    const bool can_tell = white_m > 1.0 || rate_hz > 1.0 || before + after < 2;
                    if (can_tell) {
                        EXPECT_EQ(found.origin, Origin::positions) << said;
                        EXPECT_LT(found.residual_m_s, 0.2 * found.noise_m_s) << said;
                    } else {
                        EXPECT_NE(found.origin, Origin::independent) << said;
                    }
                }
}

TEST(VelocityOrigin, NamesTheDifference) {
    const Recorded recorded{.rate_hz = 5.0, .white_m = 0.5};
    const Rows rows = with_computed_speeds(recorded, Difference::backward, 2, 0, 0.01);
    const auto found = velocities::origin_of_speeds(rows, recorded.step_m);
    EXPECT_EQ(found.difference, Difference::backward);
    EXPECT_EQ(found.before, 2);
    EXPECT_EQ(found.after, 0);
    EXPECT_NEAR(found.noise_m_s, 0.5 * std::sqrt(2.0) / 0.6, 0.1);
    EXPECT_GT(found.compared, 1400U);
}

TEST(VelocityOrigin, WhatRoundingHidesIsUnclear) {
    // Positions good to 5 mm at 1 Hz, speeds to 0.1 km/h: a difference is no worse than a speed.
    const Recorded recorded{.rate_hz = 1.0, .white_m = 0.005, .step_m = 0.001};
    const Rows rows =
        with_computed_speeds(recorded, Difference::central, 0, 0, kilometre_an_hour_tenth);
    EXPECT_EQ(velocities::origin_of_speeds(rows, recorded.step_m).origin, Origin::unclear);
}

TEST(VelocityOrigin, TooFewEpochsAreUnclear) {
    const Recorded recorded{.rate_hz = 1.0};
    Rows rows = with_computed_speeds(recorded, Difference::backward, 0, 0, 0.01);
    rows.resize(30);
    EXPECT_EQ(velocities::origin_of_speeds(rows, recorded.step_m).origin, Origin::unclear);
    EXPECT_EQ(velocities::origin_of_speeds({}, 0.01).origin, Origin::unclear);
    for (SpeedBesidePosition& row : rows)
        row.speed_m_s.reset();
    EXPECT_EQ(velocities::origin_of_speeds(rows, 0.01).compared, 0U);
}

TEST(VelocityOrigin, GapsAreNotBridged) {
    const Recorded recorded{.rate_hz = 5.0, .white_m = 0.5};
    Rows rows = with_computed_speeds(recorded, Difference::backward, 0, 0, 0.01);
    Rows gappy;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (i % 40 < 30) gappy.push_back(rows[i]);
    const auto found = velocities::origin_of_speeds(gappy, recorded.step_m);
    EXPECT_EQ(found.origin, Origin::positions);
    EXPECT_LT(found.compared, gappy.size() * 30 / 31);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
