#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/local_motion.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A part of a motion along a line whose speed swings by `swing_m_s` every four seconds.
struct Part {
    double duration_s = 0.0;
    double swing_m_s = 0.0;
};

/// At 10 Hz, 10 mm white and stated, the second axis at rest.
template <int Axes>
std::vector<ArcEpoch<Axes>> arc_of(const std::vector<Part>& parts, std::uint64_t seed = 1) {
    constexpr double sigma_m = 0.010;
    constexpr double rate = 2.0 * std::numbers::pi / 4.0;
    RandomGenerator random(seed);
    std::vector<ArcEpoch<Axes>> arc;
    double begin_s = 0.0;
    for (const Part& part : parts) {
        for (double t = 0.0; t < part.duration_s - 0.05; t += 0.1) {
            PositionMeasurement<Axes> measurement;
            measurement.covariance = sigma_m * sigma_m * PositionMatrix<Axes>::Identity();
            for (int axis = 0; axis < Axes; ++axis)
                measurement.position(axis) = sigma_m * random.normal();
            measurement.position(0) +=
                5.0 * (begin_s + t) + part.swing_m_s / rate * (1.0 - std::cos(rate * t));
            arc.push_back({.time_s = begin_s + t, .measurement = measurement});
        }
        begin_s += part.duration_s;
    }
    return arc;
}

template <int Axes>
LocalMotion motion_of(const std::vector<std::vector<ArcEpoch<Axes>>>& arcs) {
    std::vector<std::span<const ArcEpoch<Axes>>> spans(arcs.begin(), arcs.end());
    return local_motion<Axes>(spans);
}

/// The smallest and the largest density of an arc between two times.
struct Range {
    double least;
    double largest;
};
Range range_between(const std::vector<double>& density, double from_s, double to_s) {
    const auto [least, largest] = std::minmax_element(density.begin() + std::llround(10.0 * from_s),
                                                      density.begin() + std::llround(10.0 * to_s));
    return {*least, *largest};
}

template <int Axes>
void expect_to_follow() {
    // Speeds that swing by 2 m/s in 4 s have a jerk of up to 4.9 m/s^3.
    const LocalMotion motion = motion_of<Axes>({arc_of<Axes>({{120, 0}, {40, 2}, {120, 0}})});
    ASSERT_EQ(motion.jerk_density.size(), 1U);
    const std::vector<double>& density = motion.jerk_density.front();
    ASSERT_EQ(density.size(), 2800U);
    const Range moving = range_between(density, 120, 160);
    EXPECT_GT(moving.least, 1.0);
    EXPECT_LT(moving.largest, 10.0);
    // Each two seconds are looked at with the ten before and after.
    for (const auto& [from_s, to_s] : {std::pair(0.0, 106.0), std::pair(174.0, 280.0)})
        EXPECT_LT(range_between(density, from_s, to_s).largest, 0.1 * moving.least);
    EXPECT_GT(motion.whole, range_between(density, 0, 106).largest);
    EXPECT_LT(motion.whole, moving.largest);
    EXPECT_NEAR(motion.scale, 1.0, 0.05);
}

TEST(LocalMotion, RisesWhereTheCraftMovesAndNowhereElse) {
    expect_to_follow<1>();
    expect_to_follow<2>();
}

TEST(LocalMotion, AMinuteAfterTwentyIsWhatItIsAlone) {
    // One density for all of it has the minute hardly move.
    const LocalMotion alone = motion_of<2>({arc_of<2>({{60, 2}}, 3)});
    const LocalMotion waited = motion_of<2>({arc_of<2>({{1200, 0}, {60, 2}}, 3)});
    EXPECT_LT(waited.whole, 0.3 * alone.whole);
    const Range moving = range_between(waited.jerk_density.front(), 1202, 1260);
    EXPECT_GT(moving.least, 0.5 * alone.whole);
    EXPECT_LT(moving.largest, 2.0 * alone.whole);
}

TEST(LocalMotion, IsThatOfTheModelThatAnArcIsDrawnFrom) {
    // As near as a grid of powers of e tells.
    for (const double drawn : {0.05, 0.6, 5.0}) {
        EstimationModel model;
        model.motion.jerk_density = drawn;
        model.measurement_scale = 1.7;
        RandomGenerator random(4);
        const LocalMotion motion =
            motion_of<2>({test::simulate_arc<2>(model, 3000, 0.1, 0.010, random).arc});
        EXPECT_LT(std::abs(std::log(motion.whole / drawn)), std::log(1.5)) << drawn;
        EXPECT_NEAR(motion.scale / 1.7, 1.0, 0.12) << drawn;
        for (const double local : motion.jerk_density.front())
            EXPECT_LT(std::abs(std::log(local / drawn)), std::log(3.0)) << drawn;
    }
}

TEST(LocalMotion, OfNoiseAloneIsThatOfNoMotion) {
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
        const LocalMotion motion = motion_of<2>({arc_of<2>({{600, 0}}, seed)});
        // The least that is told apart is 0.01 m s^-2.5; a land yacht's own is 0.6.
        EXPECT_LT(motion.whole, 0.02) << seed;
        EXPECT_LT(range_between(motion.jerk_density.front(), 0, 600).largest, 0.06) << seed;
        EXPECT_NEAR(motion.scale, 1.0, 0.05) << seed;
    }
}

TEST(LocalMotion, DoesNotHangOnHowLargeTheErrorsAreStated) {
    // By e, which is a step of the grid: the same but for which point of it is nearest to a place.
    auto arc = arc_of<2>({{40, 0}, {30, 2}, {40, 0}});
    const LocalMotion motion = motion_of<2>({arc});
    for (ArcEpoch<2>& epoch : arc)
        epoch.measurement->covariance /= std::exp(2.0);
    const LocalMotion other = motion_of<2>({arc});
    EXPECT_NEAR(other.scale / motion.scale, std::exp(1.0), 0.02);
    const Range moving = range_between(motion.jerk_density.front(), 40, 70);
    const Range same = range_between(other.jerk_density.front(), 40, 70);
    EXPECT_NEAR(same.least / moving.least, 1.0, 0.01);
    EXPECT_NEAR(same.largest / moving.largest, 1.0, 0.01);
}

TEST(LocalMotion, OfTenSecondsIsThatOfTheWhole) {
    // Every look takes in all of it, and the prior about the whole's moves nothing.
    const LocalMotion motion = motion_of<2>({arc_of<2>({{10, 1}})});
    ASSERT_EQ(motion.jerk_density.front().size(), 100U);
    for (const double local : motion.jerk_density.front())
        EXPECT_NEAR(local / motion.whole, 1.0, 1e-9);
}

TEST(LocalMotion, OfArcsApartLooksAtEachByItself) {
    const auto quiet = arc_of<2>({{60, 0}}, 5);
    const auto moving = arc_of<2>({{60, 2}}, 6);
    const LocalMotion motion = motion_of<2>({quiet, moving, quiet});
    ASSERT_EQ(motion.jerk_density.size(), 3U);
    EXPECT_LT(range_between(motion.jerk_density[0], 0, 60).largest, 0.1);
    EXPECT_GT(range_between(motion.jerk_density[1], 0, 60).least, 1.0);
    EXPECT_EQ(motion.jerk_density[0], motion.jerk_density[2]);
}

TEST(LocalMotion, IsTheSameTwice) {
    const auto arc = arc_of<2>({{30, 0}, {20, 1}});
    const LocalMotion once = motion_of<2>({arc});
    const LocalMotion again = motion_of<2>({arc});
    EXPECT_EQ(once.whole, again.whole);
    EXPECT_EQ(once.scale, again.scale);
    EXPECT_EQ(once.jerk_density, again.jerk_density);
}

TEST(LocalMotion, OfArcsTooShortToTellSaysNothing) {
    const auto arc = arc_of<2>({{10, 1}});
    const auto first = [&](std::ptrdiff_t epochs) {
        return std::vector<ArcEpoch<2>>(arc.begin(), arc.begin() + epochs);
    };
    // Three measurements of each arc tell where it is and how it moves.
    for (const std::ptrdiff_t epochs : {1, 2, 3}) {
        const LocalMotion motion = motion_of<2>({first(epochs), first(epochs)});
        EXPECT_TRUE(motion.jerk_density.empty()) << epochs;
        EXPECT_EQ(motion.whole, 0.0) << epochs;
        EXPECT_EQ(motion.scale, 1.0) << epochs;
    }
    EXPECT_TRUE(motion_of<2>({}).jerk_density.empty());
    // One that says nothing beside one that does has what the other is as a whole.
    const LocalMotion beside = motion_of<2>({first(2), arc});
    ASSERT_EQ(beside.jerk_density.size(), 2U);
    ASSERT_EQ(beside.jerk_density.front().size(), 2U);
    EXPECT_NEAR(beside.jerk_density.front().front() / beside.whole, 1.0, 1e-9);
}

TEST(LocalMotion, GoesOnAcrossEpochsWithoutAMeasurement) {
    auto arc = arc_of<2>({{60, 0}, {30, 2}});
    for (std::size_t k = 100; k < 300; ++k)
        arc[k].measurement.reset();
    const LocalMotion motion = motion_of<2>({arc});
    ASSERT_EQ(motion.jerk_density.front().size(), 900U);
    EXPECT_LT(range_between(motion.jerk_density.front(), 0, 46).largest, 0.3);
    EXPECT_GT(range_between(motion.jerk_density.front(), 60, 90).least, 1.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
