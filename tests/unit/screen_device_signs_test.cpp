#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/screen/device_signs.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Rows = std::vector<ScreenedEpoch>;

/// A craft on a circle of 200 m radius, as a receiver measures it at 10 Hz.
struct Recording {
    std::size_t epochs = 600;
    double speed_m_s = 15.0;
    double noise_m = 0.010;
    double resolution_m = 0.0;  ///< positions are written in whole steps of this
    std::uint64_t seed = 1;
};

double written(double value_m, double resolution_m) {
    return resolution_m > 0.0 ? resolution_m * std::round(value_m / resolution_m) : value_m;
}

Rows record(const Recording& recording) {
    RandomGenerator random(recording.seed);
    Rows rows;
    for (std::size_t k = 0; k < recording.epochs; ++k) {
        const double angle = recording.speed_m_s * 0.1 * static_cast<double>(k) / 200.0;
        ScreenedEpoch& row = rows.emplace_back();
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        row.east_m = written(200.0 * std::sin(angle) + recording.noise_m * random.normal(),
                             recording.resolution_m);
        row.north_m = written(200.0 * std::cos(angle) + recording.noise_m * random.normal(),
                              recording.resolution_m);
        row.fix = FixType::fixed;
    }
    return rows;
}

/// The position of each row made from those of others, in the order of the rows.
template <class Made>
Rows with(Rows rows, const Made& made) {
    const auto at = [&](std::size_t k) {
        return Eigen::Vector2d(*rows[k].east_m, *rows[k].north_m);
    };
    for (std::size_t k = 2; k + 1 < rows.size(); ++k) {
        const Eigen::Vector2d position = made(k, at);
        rows[k].east_m = position.x();
        rows[k].north_m = position.y();
    }
    return rows;
}

DeviceSigns signs_of(const Rows& rows, double resolution_m = 0.0) {
    return find_device_signs(rows, 0.1, resolution_m);
}

TEST(DeviceSigns, AnHonestRecordingHasNone) {
    for (const double noise_m : {0.002, 0.010, 0.5})
        for (const std::uint64_t seed : {1U, 2U, 3U}) {
            const DeviceSigns signs = signs_of(record({.noise_m = noise_m, .seed = seed}));
            // All but the five rows at each end.
            EXPECT_EQ(signs.moving, 590);
            EXPECT_EQ(signs.held, 0);
            EXPECT_LE(signs.interpolated, 1) << noise_m << " " << seed;
            EXPECT_LT(signs.by_chance, 1.0);
        }
}

TEST(DeviceSigns, OfHonestCoarseCoordinatesAreAboutAsManyAsChanceMakes) {
    // What is equal by rounding is expected: as much of it as a rule that allows three times that,
    // or a few, must never refuse; nor so much that nothing could be found.
    for (const double speed_m_s : {3.0, 15.0, 40.0})
        for (const double noise_m : {0.0005, 0.002, 0.010})
            for (const double resolution_m : {0.001, 0.002, 0.005, 0.011, 0.020}) {
                const DeviceSigns signs = signs_of(record({.epochs = 3000,
                                                           .speed_m_s = speed_m_s,
                                                           .noise_m = noise_m,
                                                           .resolution_m = resolution_m}),
                                                   resolution_m);
                const auto found = static_cast<double>(signs.interpolated);
                EXPECT_EQ(signs.moving, 2990);
                EXPECT_EQ(signs.held, 0);
                EXPECT_LE(found, 3.0 * signs.by_chance + 10.0)
                    << speed_m_s << " " << noise_m << " " << resolution_m;
                EXPECT_LE(signs.by_chance, 3.0 * found + 60.0)
                    << speed_m_s << " " << noise_m << " " << resolution_m;
            }
}

TEST(DeviceSigns, PositionsHeldAreCounted) {
    // 5 Hz written at 10.
    const Rows every_second = with(
        record({}), [](std::size_t k, const auto& at) { return k % 2 == 1 ? at(k - 1) : at(k); });
    const DeviceSigns half = signs_of(every_second);
    EXPECT_NEAR(static_cast<double>(half.held), 295.0, 1.0);
    // Three in a row, once.
    const Rows stuck = with(record({}), [](std::size_t k, const auto& at) {
        return k >= 300 && k < 303 ? at(k - 1) : at(k);
    });
    const DeviceSigns once = signs_of(stuck);
    EXPECT_EQ(once.held, 3);
    EXPECT_LE(once.interpolated, 1);
}

TEST(DeviceSigns, PositionsBetweenTwoMeasuredOnesAreCounted) {
    const auto between = [](std::size_t k, const auto& at) -> Eigen::Vector2d {
        if (k % 2 == 0) return at(k);
        return 0.5 * (at(k - 1) + at(k + 1));
    };
    const DeviceSigns signs = signs_of(with(record({}), between));
    EXPECT_NEAR(static_cast<double>(signs.interpolated), 295.0, 2.0);
    EXPECT_GT(static_cast<double>(signs.interpolated), 20.0 * (signs.by_chance + 1.0));
    EXPECT_EQ(signs.held, 0);
}

TEST(DeviceSigns, FourOfFiveBetweenMeasuredOnesInWholeMillimetresAreCounted) {
    Rows rows = record({.epochs = 3000});
    const Rows measured = rows;
    for (std::size_t k = 0; k + 5 < rows.size(); ++k) {
        const double share = static_cast<double>(k % 5) / 5.0;
        const ScreenedEpoch& from = measured[k - k % 5];
        const ScreenedEpoch& to = measured[k - k % 5 + 5];
        rows[k].east_m = written((1.0 - share) * *from.east_m + share * *to.east_m, 0.001);
        rows[k].north_m = written((1.0 - share) * *from.north_m + share * *to.north_m, 0.001);
    }
    const DeviceSigns signs = signs_of(rows, 0.001);
    // Rounding hides some of the 2392.
    EXPECT_GT(signs.interpolated, 1200);
    EXPECT_GT(static_cast<double>(signs.interpolated), 10.0 * signs.by_chance);
}

/// Rows of 1 Hz, with `between` rows made out of four of them from one to the next.
template <class Curve>
Rows resampled(const Rows& measured, std::int64_t between, double resolution_m, Curve curve) {
    Rows rows;
    const auto knot = [&](std::size_t k) {
        return Eigen::Vector2d(*measured[k].east_m, *measured[k].north_m);
    };
    for (std::size_t k = 1; k + 2 < measured.size(); ++k)
        for (std::int64_t j = 0; j < between; ++j) {
            const double share = static_cast<double>(j) / static_cast<double>(between);
            const Eigen::Vector2d place =
                curve(knot(k - 1), knot(k), knot(k + 1), knot(k + 2), share);
            ScreenedEpoch& row = rows.emplace_back(measured[k]);
            row.time.nanoseconds =
                static_cast<std::int64_t>(rows.size() - 1) * 1'000'000'000 / between;
            row.east_m = written(place.x(), resolution_m);
            row.north_m = written(place.y(), resolution_m);
        }
    return rows;
}

Eigen::Vector2d on_a_line(const Eigen::Vector2d&, const Eigen::Vector2d& from,
                          const Eigen::Vector2d& to, const Eigen::Vector2d&, double share) {
    return (1.0 - share) * from + share * to;
}

/// The cubic of Catmull and Rom, whose slope at a knot is that between the knots beside it.
Eigen::Vector2d on_a_spline(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                            const Eigen::Vector2d& c, const Eigen::Vector2d& d, double t) {
    return b +
           0.5 * t *
               ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)));
}

TEST(DeviceSigns, RowsOnLinesAndSplinesBetweenFixesASecondApartAreCounted) {
    for (const std::int64_t rate : {5, 10, 20})
        for (const double resolution_m : {0.0001, 0.001, 0.011}) {
            // 200 fixes a second apart: ten steps of the circle's 10 Hz at a tenth of the speed.
            const Rows fixes = record({.epochs = 200, .speed_m_s = 150.0, .noise_m = 0.01});
            const auto count = [&](const auto& curve) {
                const Rows rows = resampled(fixes, rate, resolution_m, curve);
                const DeviceSigns signs =
                    find_device_signs(rows, 1.0 / static_cast<double>(rate), resolution_m);
                EXPECT_LE(signs.interpolated, signs.moving);
                return static_cast<double>(signs.interpolated) /
                       std::max(static_cast<double>(signs.moving), 3.0 * signs.by_chance);
            };
            EXPECT_GT(count(on_a_line), 0.75) << rate << " " << resolution_m;
            // What rounding covers at the knots themselves no test can see.
            if ((resolution_m < 0.001 && rate < 20) || (resolution_m < 0.01 && rate < 10)) {
                EXPECT_GT(count(on_a_spline), 0.75) << rate << " " << resolution_m;
            }
        }
}

TEST(DeviceSigns, RowsBeforeTheFirstEpochCountAsThoseBehindIt) {
    // A stretch that was written later may lie before the recording's first epoch.
    const Rows fixes = record({.epochs = 200, .speed_m_s = 150.0, .noise_m = 0.01});
    Rows rows = resampled(fixes, 10, 0.001, on_a_line);
    const DeviceSigns behind = signs_of(rows, 0.001);
    for (ScreenedEpoch& row : rows)
        row.time.nanoseconds -= 123'400'000'000;
    const DeviceSigns before = signs_of(rows, 0.001);
    EXPECT_EQ(before.interpolated, behind.interpolated);
    EXPECT_EQ(before.by_chance, behind.by_chance);
}

TEST(DeviceSigns, StepsAtEveryTenthRowOfAnHonestRecordingAreNoSign) {
    // As corrections make them that come once a second, beside coarse coordinates.
    for (const double step_m : {0.01, 0.03, 0.1})
        for (const double noise_m : {0.0001, 0.002, 0.01})
            for (const double resolution_m : {0.001, 0.011}) {
                Rows rows = record({.epochs = 3000, .noise_m = noise_m});
                RandomGenerator random(7);
                double east_m = 0.0;
                for (std::size_t k = 0; k < rows.size(); ++k) {
                    if (k % 10 == 0) east_m = step_m * random.normal();
                    rows[k].east_m = written(*rows[k].east_m + east_m, resolution_m);
                    rows[k].north_m = written(*rows[k].north_m, resolution_m);
                }
                const DeviceSigns signs = signs_of(rows, resolution_m);
                EXPECT_LE(static_cast<double>(signs.interpolated), 3.0 * signs.by_chance + 10.0)
                    << step_m << " " << noise_m << " " << resolution_m;
            }
}

TEST(DeviceSigns, PositionsCarriedOnFromMeasuredOnesAreCounted) {
    // For half a second along a parabola, as a device predicts with speed and acceleration.
    const Rows predicted = with(record({}), [](std::size_t k, const auto& at) -> Eigen::Vector2d {
        if (k < 300 || k >= 305) return at(k);
        return 3.0 * at(k - 1) - 3.0 * at(k - 2) + at(k - 3);
    });
    const DeviceSigns signs = signs_of(predicted);
    EXPECT_GE(signs.interpolated, 4);
    EXPECT_LE(signs.interpolated, 6);
    EXPECT_LT(signs.by_chance, 1.0);
}

TEST(DeviceSigns, ACraftAtRestIsNotLookedAt) {
    Rows rows = record({.speed_m_s = 0.0});
    for (ScreenedEpoch& row : rows) {
        row.east_m = 3.0;
        row.north_m = 4.0;
    }
    const DeviceSigns signs = signs_of(rows);
    EXPECT_EQ(signs.moving, 0);
    EXPECT_EQ(signs.held, 0);
    EXPECT_EQ(signs.interpolated, 0);
    EXPECT_EQ(signs.by_chance, 0.0);
    // Nor one whose steps the coordinates do not tell.
    EXPECT_EQ(signs_of(record({.speed_m_s = 1.5, .resolution_m = 0.1}), 0.1).moving, 0);
    EXPECT_EQ(signs_of(record({.speed_m_s = 1.5})).moving, 590);
}

TEST(DeviceSigns, RowsLostOrWithoutAFixAreNoSign) {
    // Straight on with equal steps across a hole of five rows: its ends are far from one another.
    Rows rows = record({});
    rows.erase(rows.begin() + 300, rows.begin() + 305);
    EXPECT_EQ(signs_of(rows).moving, 595 - 20);
    rows = record({});
    for (std::size_t k = 300; k < 310; ++k) {
        rows[k].reason = Reason::no_fix;
        rows[k].east_m = rows[k].north_m = 0.0;
    }
    const DeviceSigns signs = signs_of(rows);
    EXPECT_EQ(signs.held, 0);
    EXPECT_EQ(signs.moving, 590 - 20);
    for (std::size_t k = 300; k < 310; ++k)
        rows[k].east_m.reset();
    EXPECT_EQ(signs_of(rows).moving, 590 - 20);
}

TEST(DeviceSigns, OfNothingAndOfNoIntervalThereAreNone) {
    EXPECT_EQ(signs_of({}).moving, 0);
    EXPECT_EQ(signs_of(record({.epochs = 10})).moving, 0);
    EXPECT_EQ(signs_of(record({.epochs = 11})).moving, 1);
    EXPECT_EQ(find_device_signs(record({}), 0.0, 0.0).moving, 0);
}

TEST(DeviceSigns, OfARecordingThatIsAllMadeAreNotTakenForChance) {
    // Straight at constant speed to the last digit: nothing scatters that chance could work on.
    Rows rows = record({});
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].east_m = 1.5 * static_cast<double>(k);
        rows[k].north_m = 0.25 * static_cast<double>(k);
    }
    const DeviceSigns signs = signs_of(rows);
    EXPECT_EQ(signs.interpolated, signs.moving);
    EXPECT_EQ(signs.by_chance, 0.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
