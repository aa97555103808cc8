#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/window/position_speed.h"
#include "stages/window/stands.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double interval_s = 0.1;
constexpr double stated_m = 0.010;

/// Positions of a craft that stands for 100 s, at 10 Hz: white noise as stated, a Gauss-Markov
/// error, and a drift.
struct Standing {
    double correlated_m = 0.0;
    double tau_s = 1.0;
    double drift_m_s = 0.0;
    double white_m = stated_m;
};

ScreenedTable table_of(const Standing& errors, std::uint64_t seed = 1) {
    RandomGenerator random(seed);
    ScreenedTable table;
    table.facts.nominal_interval_s = interval_s;
    const double keep = std::exp(-interval_s / errors.tau_s);
    Eigen::Vector2d slow = errors.correlated_m * Eigen::Vector2d(random.normal(), random.normal());
    for (std::int64_t k = 0; k < 1000; ++k) {
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        slow = keep * slow + std::sqrt(1.0 - keep * keep) * errors.correlated_m *
                                 Eigen::Vector2d(random.normal(), random.normal());
        const double drifted = errors.drift_m_s * row.time.seconds();
        row.east_m = slow.x() + drifted + errors.white_m * random.normal();
        row.north_m = slow.y() + drifted + errors.white_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = stated_m;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    return table;
}

std::vector<Stand> stands_in(const ScreenedTable& screened,
                             const std::vector<StillSpan>& spans = {{0.0, 99.0}}) {
    return stands_of(screened, {}, spans, nullptr);
}

std::optional<double> error_of(const Standing& errors, double lag_s = 3.0, double scale = 1.0) {
    const ScreenedTable table = table_of(errors);
    return standing_error_m<2>(table, stands_in(table), FixType::fixed, lag_s, scale);
}

TEST(Stands, ShowTheSizeOfACorrelatedError) {
    // Over three times its correlation time the error moves by 0.95 of twice its variance.
    EXPECT_NEAR(*error_of({.correlated_m = 0.050}), 0.0487, 0.008);
    EXPECT_LT(*error_of({}), 0.003);
}

// A craft that creeps looks as positions that drift do.
TEST(Stands, ASteadyMovementIsSaidAndTakenOff) {
    const ScreenedTable table = table_of({.drift_m_s = 0.020});
    const auto stands = stands_in(table);
    EXPECT_NEAR(*stands[0].drift_m_s, 0.020 * std::sqrt(2.0), 0.0005);
    EXPECT_NEAR(*stands[0].moved_m, std::sqrt(2.0) * stated_m, 0.002);
    EXPECT_LT(*standing_error_m<2>(table, stands, FixType::fixed, 3.0, 1.0), 0.003);
    EXPECT_NE(standing_text(stands).find("by up to 0.028 m/s: the craft crept, or they drift"),
              std::string::npos)
        << standing_text(stands);
    EXPECT_EQ(standing_text(stands_in(table_of({}))).find("crept"), std::string::npos);
}

TEST(Stands, TheScaleOfTheWhiteNoiseIsTakenOff) {
    EXPECT_NEAR(*error_of({.white_m = 0.030}), std::sqrt(0.0009 - 0.0001), 0.003);
    EXPECT_LT(*error_of({.white_m = 0.030}, 3.0, 3.0), 0.010);
}

TEST(Stands, OfTooFewSpansOfTheWindowsTimeNothingIsTaken) {
    EXPECT_FALSE(error_of({}, 30.0));
    const ScreenedTable table = table_of({});
    EXPECT_FALSE(
        standing_error_m<2>(table, stands_in(table, {{0.0, 12.0}}), FixType::fixed, 3.0, 1.0));
}

TEST(Stands, OnlyUsableEpochsOfTheWindowsFixTypeCount) {
    ScreenedTable table = table_of({});
    for (std::size_t k = 0; k < table.rows.size(); k += 2) {
        table.rows[k].fix = FixType::float_ambiguities;
        *table.rows[k].east_m += 5.0 * std::sin(0.3 * static_cast<double>(k));
    }
    EXPECT_LT(*standing_error_m<2>(table, stands_in(table), FixType::fixed, 3.0, 1.0), 0.004);
    EXPECT_GT(*standing_error_m<2>(table, stands_in(table), FixType::float_ambiguities, 3.0, 1.0),
              1.0);
    for (std::size_t k = 1; k < table.rows.size(); k += 4) {
        *table.rows[k].north_m += 5.0;
        table.rows[k].usable = false;
    }
    EXPECT_LT(*standing_error_m<2>(table, stands_in(table), FixType::fixed, 2.0, 1.0), 0.004);
}

TEST(Stands, AStampThatIsWrongDoesNotEndThem) {
    ScreenedTable table = table_of({});
    for (const std::size_t k : {200U, 500U}) {
        table.rows[k].time = {k == 200U ? 900'000'000'000 : 0};
        table.rows[k].usable = false;
    }
    // Pairs over 1 s of 1000 epochs; each of the two is in two of them.
    EXPECT_EQ(stands_in(table)[0].pairs, stands_in(table_of({}))[0].pairs - 4);
}

TEST(Stands, StandsByPositionsAloneDecideNothing) {
    const ScreenedTable table = table_of({.correlated_m = 0.050});
    TrajectoryTable trajectory;
    for (const ScreenedEpoch& epoch : table.rows) {
        TrajectoryEpoch& row = trajectory.rows.emplace_back();
        row.time = epoch.time;
        row.arc = 1;
        row.east_m = row.north_m = 0.005 * epoch.time.seconds();
    }
    const auto stands = stands_of(table, trajectory, {}, nullptr);
    ASSERT_EQ(stands.size(), 1U);
    EXPECT_EQ(stands[0].shown_by, StandSource::positions);
    EXPECT_NEAR(stands[0].to_s - stands[0].from_s, 89.9, 1e-6);
    EXPECT_FALSE(standing_error_m<2>(table, stands, FixType::fixed, 3.0, 1.0));
    EXPECT_NE(standing_text(stands).find("Either the craft moved"), std::string::npos)
        << standing_text(stands);
    // A craft that leaves a metre within half a minute does not stand.
    for (TrajectoryEpoch& row : trajectory.rows)
        row.east_m = 0.05 * row.time.seconds();
    EXPECT_TRUE(stands_of(table, trajectory, {}, nullptr).empty());
}

TEST(Stands, AWheelThatDoesNotTurnShowsAStand) {
    const ScreenedTable table = table_of({});
    MeasuredSeries wheel;
    for (int k = 0; k <= 200; ++k)
        wheel.samples.push_back({.time_s = 0.5 * k, .value = k < 20 || k > 100 ? 3.0 : 0.0});
    const auto stands = stands_of(table, {}, {}, &wheel);
    ASSERT_EQ(stands.size(), 1U);
    EXPECT_EQ(stands[0].shown_by, StandSource::wheel);
    EXPECT_NEAR(stands[0].from_s, 11.0, 1e-9);
    EXPECT_NEAR(stands[0].to_s, 49.0, 1e-9);
    EXPECT_NEAR(*stands[0].moved_m, *stands[0].stated_m, 0.002);
    EXPECT_NEAR(*stands[0].stated_m, std::sqrt(2.0) * stated_m, 1e-12);
    // One that is dead, or counts from some speed on, is found out by the positions.
    TrajectoryTable trajectory;
    for (const ScreenedEpoch& epoch : table.rows) {
        TrajectoryEpoch& row = trajectory.rows.emplace_back();
        row.time = epoch.time;
        row.speed_m_s = epoch.time.seconds() > 30.0 ? 1.5 : 0.0;
    }
    EXPECT_TRUE(stands_of(table, trajectory, {}, &wheel).empty());
}

TEST(Stands, TheSentenceSaysWhetherTheStatedAccuracyHolds) {
    const auto text = [](const Standing& errors) {
        return standing_text(stands_in(table_of(errors)));
    };
    EXPECT_EQ(text({}).find("err by more"), std::string::npos) << text({});
    EXPECT_NE(text({}).find("By its IMU the craft stood for 99 s"), std::string::npos);
    EXPECT_NE(text({.correlated_m = 0.05}).find("err by more than they state"), std::string::npos);
    EXPECT_NE(text({.white_m = 0.001}).find("hold positions at rest"), std::string::npos);
    int wrong = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed)
        wrong +=
            standing_text(stands_in(table_of({}, seed))).find("err by more") != std::string::npos;
    EXPECT_LE(wrong, 2);  // one in a thousand each; three by chance once in 900 such tests
    EXPECT_EQ(standing_text({}), "");
    EXPECT_EQ(standing_text(stands_in(table_of({}), {{0.0, 14.0}})), "");
}

TEST(Stands, WhatTheyShowIsTheBoundWhereItIsTheLargest) {
    const ScreenedTable table = table_of({.correlated_m = 0.050});
    NoiseSummary noise;
    noise.measurement_scale = test::parameter_of(1.0);
    const UncertaintyRule rule{.tau_min_s = 0.5,
                               .tau_max_s = 10.0,
                               .selection_bias = SelectionTreatment::covered,
                               .error_floor_m = {{"fixed", 0.020}}};
    const auto bound_with = [&](const std::vector<Stand>& stands) {
        return error_bound<2>(table, 500, 530, noise, rule, 1.0, stands);
    };
    const ErrorBound bound = bound_with(stands_in(table));
    EXPECT_EQ(bound.decided_by, BoundSource::standing);
    EXPECT_EQ(bound.sigma_m, bound.standing_m);
    EXPECT_NEAR(bound.sigma_m, 0.0487, 0.008);
    EXPECT_EQ(bound_with({}).decided_by, BoundSource::floor);
    EXPECT_FALSE(bound_with({}).standing_m);
}

/// An IMU at 100 Hz that vibrates with a size that depends on the time.
std::vector<ImuSample> vibrating(const std::function<double(double)>& force_m_s2, double last_s) {
    RandomGenerator random(5);
    std::vector<ImuSample> samples;
    for (int k = 1; k <= 100.0 * last_s; ++k) {
        const double time_s = 0.01 * k;
        const auto draw = [&](double size) -> Eigen::Vector3d {
            return 0.01 * size * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
        };
        samples.push_back({.time_s = time_s,
                           .interval_s = 0.01,
                           .angle_rad = draw(0.05 * force_m_s2(time_s)),
                           .velocity_m_s = draw(force_m_s2(time_s))});
    }
    return samples;
}

TEST(StillSpans, AreWhereTheImuFeelsNoMotion) {
    const auto moves = [](double time_s) { return time_s > 40.0 && time_s < 90.0; };
    const auto speed = [&](double time_s) { return moves(time_s) ? 20.0 : 0.0; };
    const auto samples =
        vibrating([&](double time_s) { return moves(time_s) ? 1.0 : 0.02; }, 130.0);
    const auto spans = still_spans(samples, speed);
    ASSERT_EQ(spans.size(), 2U);
    EXPECT_NEAR(spans[0].from_s, 3.0, 1e-6);
    EXPECT_NEAR(spans[0].to_s, 37.0, 1e-6);
    EXPECT_NEAR(spans[1].from_s, 93.0, 1e-6);
    EXPECT_NEAR(spans[1].to_s, 127.0, 1e-6);
}

TEST(StillSpans, AnImuThatFeelsTheSameAtSpeedShowsNone) {
    const auto speed = [](double time_s) { return time_s > 40.0 ? 20.0 : 0.0; };
    EXPECT_TRUE(still_spans(vibrating([](double) { return 0.1; }, 100.0), speed).empty());
    // Nor where it creeps, vibrates more than elsewhere, has no samples, or never moves.
    const auto quiet = [](double time_s) { return time_s > 40.0 ? 1.0 : 0.02; };
    const auto unknown = [](double) { return std::nan(""); };
    EXPECT_TRUE(still_spans(vibrating(quiet, 100.0), [](double time_s) {
                    return time_s > 40.0 ? 20.0 : 0.7;
                }).empty());
    EXPECT_TRUE(still_spans(vibrating(quiet, 100.0), unknown).empty());
    EXPECT_TRUE(still_spans({}, speed).empty());
    auto gappy = vibrating(quiet, 100.0);
    std::erase_if(gappy, [](const ImuSample& one) { return std::fmod(one.time_s, 10.0) < 0.5; });
    EXPECT_TRUE(still_spans(gappy, speed).empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
