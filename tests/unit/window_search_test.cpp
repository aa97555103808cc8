#include <gtest/gtest.h>

#include <numeric>

#include "core/failure.h"
#include "stages/window/best_window_sums.h"
#include "window_search_support.h"
#include "witness/window_speed.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::alpha;
using test::any_alpha;
using test::displacement;
using test::options_of;
using test::over_distance;
using test::over_time;
using test::path_length;
using test::random_track;
using test::SearchTrack;

TEST(RuleSearch, TakesTimeInProportionToTheSamples) {
    test::TrackOptions options = options_of(0);
    options.epochs = 20'000;
    const SearchTrack track = random_track(options);
    options.epochs = 200'000;
    const SearchTrack longer = random_track(options);
    for (const WindowCriteria& rule :
         {over_time(3.0, displacement), over_time(3.0, displacement, WindowEnds::any),
          over_distance(500.0, path_length), over_distance(500.0, path_length, WindowEnds::any),
          over_distance(100.0, displacement), alpha(500.0)}) {
        const auto few = search_windows(track.series, rule, 5).steps;
        const auto many = search_windows(longer.series, rule, 5).steps;
        EXPECT_GT(few, 20'000);
        EXPECT_LT(many, 12 * few);  // ten times, and what chance adds to the tracks
    }
}

TEST(RuleSearch, ALongStandCostsNoMoreThanDocumented) {
    RandomGenerator random(5);
    SampleSeries standing;
    for (std::int64_t k = 0; k < 10'000; ++k) {
        standing.times.push_back({k * 100'000'000});
        standing.positions.emplace_back(0.004 * random.normal(), 0.004 * random.normal(), 0.0);
    }
    EXPECT_LE(search_windows({standing}, alpha(500.0), 1).steps, 20'000);
    EXPECT_LE(search_windows({standing}, alpha(1.0), 1).steps, 40'000);
    EXPECT_LE(search_windows({standing}, over_distance(100.0, displacement), 1).steps, 100'000);
}

/// Due north at a constant speed along the first axis, at 10 Hz.
SampleSeries steady(double speed_m_s, std::int64_t epochs) {
    SampleSeries series;
    for (std::int64_t k = 0; k < epochs; ++k) {
        series.times.push_back({k * 100'000'000});
        series.positions.emplace_back(0.0, 0.1 * speed_m_s * static_cast<double>(k), 0.0);
        series.speeds_m_s.push_back(speed_m_s);
    }
    return series;
}

TEST(RuleSearch, ADistanceReachedInSumsOfDecimalsIsReached) {
    const std::vector<SampleSeries> series{steady(11.0, 1000)};
    for (const double distance_m : {110.0, 550.0, 1089.0}) {
        const auto by_path = best_windows(series, over_distance(distance_m, path_length), 1);
        const auto straight = best_windows(series, over_distance(distance_m, displacement), 1);
        ASSERT_EQ(by_path.size(), 1u);
        ASSERT_EQ(straight.size(), 1u);
        EXPECT_NEAR(by_path[0].length_m, distance_m, 1e-9);
        EXPECT_NEAR(straight[0].length_m, distance_m, 1e-9);
    }
    for (const FoundWindow& one :
         allowed_and_best(series, over_distance(110.0, path_length), 1).all)
        EXPECT_EQ(one.last - one.first, 100u);
}

TEST(RuleSearch, AnInterpolatedEndNeedsBothSamplesAroundIt) {
    SampleSeries series = steady(10.0, 31);
    series.bounds.assign(31, true);
    WindowCriteria rule = over_time(1.05, displacement, WindowEnds::any);
    EXPECT_FALSE(best_windows({series}, rule, 1).empty());
    for (std::size_t k = 0; k < 31; k += 2)
        series.bounds[k] = false;
    EXPECT_TRUE(best_windows({series}, rule, 1).empty());
    rule.duration_s = 1.0;
    EXPECT_FALSE(best_windows({series}, rule, 1).empty());
}

TEST(RuleSearch, AnObstacleIsNotSpanned) {
    SampleSeries series = steady(10.0, 60);
    series.obstacles.assign(30, 0);
    series.obstacles.resize(60, 1);
    EXPECT_FALSE(best_windows({series}, over_time(2.9, displacement), 1).empty());
    EXPECT_TRUE(best_windows({series}, over_time(3.0, displacement), 1).empty());
    EXPECT_TRUE(
        best_windows({series}, over_distance(29.5, path_length, WindowEnds::any), 1).empty());
}

/// North by `leg_m`, 20 m east, and back south, a sample for each metre, at 10 m/s.
SampleSeries there_and_back(std::int64_t leg_m) {
    SampleSeries series;
    for (std::int64_t k = 0; k <= 2 * leg_m + 20; ++k) {
        const auto path = static_cast<double>(k), leg = static_cast<double>(leg_m);
        series.times.push_back({k * 100'000'000});
        series.positions.emplace_back(
            std::clamp(path - leg, 0.0, 20.0),
            path < leg + 20.0 ? std::min(path, leg) : 2.0 * leg + 20.0 - path, 0.0);
    }
    return series;
}

/// Beginnings of the alphas there, which must be as long as the rule has it.
std::vector<std::size_t> alphas_begin(const SampleSeries& series, const WindowCriteria& rule) {
    std::vector<std::size_t> begins;
    for (const FoundWindow& one : allowed_and_best({series}, rule, 1).all) {
        EXPECT_NEAR(one.length_m, rule.distance_m, 1e-9);
        begins.push_back(one.first);
    }
    return begins;
}

std::vector<std::size_t> from_to(std::size_t first, std::size_t last) {
    std::vector<std::size_t> all(last - first + 1);
    std::iota(all.begin(), all.end(), first);
    return all;
}

TEST(RuleSearch, AnAlphaNeedsATurnAndEndsNearOneAnother) {
    const SampleSeries series = there_and_back(300);
    // From b metres north to 120 - b: 50 m apart, or less, where 20^2 + (120 - 2 b)^2 <= 50^2.
    EXPECT_EQ(alphas_begin(series, alpha(500.0)), from_to(38, 82));
    WindowCriteria rule = alpha(500.0);
    rule.proximity_m = 20.0;
    EXPECT_EQ(alphas_begin(series, rule), from_to(60, 60));
    rule.proximity_m = 19.9;
    EXPECT_TRUE(alphas_begin(series, rule).empty()) << "the ways are 20 m apart";
    rule.proximity_m = 600.0;
    EXPECT_EQ(alphas_begin(series, rule), from_to(0, 120));
    EXPECT_TRUE(alphas_begin(steady(10.0, 700), rule).empty()) << "there is no turn";
    rule.turn_deg = 0.0;
    EXPECT_EQ(alphas_begin(steady(10.0, 700), rule), from_to(0, 199));
}

/// 250 m out and back with 60 m at a tenth of the speed at the beginning, which an alpha need not
/// hold: the longest one, of 500 m, does.
TEST(RuleSearch, AnAlphaOfAnyLengthLeavesOutWhereTheCraftWasSlow) {
    SampleSeries series = there_and_back(240);
    for (std::size_t k = 0; k < 60; ++k)
        for (std::size_t after = k + 1; after < series.times.size(); ++after)
            series.times[after].nanoseconds += 900'000'000;
    const auto longest = best_windows({series}, alpha(490.0), 1);
    const auto any = best_windows({series}, any_alpha(490.0), 1);
    ASSERT_TRUE(longest.size() == 1 && any.size() == 1);
    EXPECT_NEAR(longest[0].length_m, 490.0, 1e-9);
    EXPECT_LT(longest[0].speed_m_s, 6.0);
    EXPECT_NEAR(any[0].speed_m_s, 10.0, 1e-9);
    EXPECT_GE(any[0].first, 60U);
    EXPECT_LE(any[0].length_m, 490.0 + path_rounding_m);
    const double apart_m = (series.positions[any[0].last] - series.positions[any[0].first]).norm();
    EXPECT_LE(apart_m, 50.0);
}

/// Half a turn at full speed, its ends 50 m apart, is no way out and back.
TEST(RuleSearch, AnAlphaOfAnyLengthIsAtLeastTwiceItsProximity) {
    SampleSeries series = there_and_back(300);
    for (std::size_t k = 290; k < 330; ++k)  // ten times as fast about the turn
        for (std::size_t after = k + 1; after < series.times.size(); ++after)
            series.times[after].nanoseconds -= 90'000'000;
    const auto all = allowed_and_best({series}, any_alpha(500.0), 1);
    ASSERT_EQ(all.best.size(), 1U);
    EXPECT_NEAR(all.best[0].length_m, 100.0, 1e-9);
    for (const FoundWindow& one : all.all)
        EXPECT_GE(one.length_m, 100.0 - path_rounding_m);
    EXPECT_TRUE(std::ranges::is_sorted(all.all, {}, &FoundWindow::start));
}

/// Hours at rest, whose scatter makes a path, are not looked through for each sample.
TEST(RuleSearch, AnAlphaOfAnyLengthCostsNoMoreWhereTheCraftRests) {
    SampleSeries series = there_and_back(300);
    const std::size_t moving = series.times.size();
    for (std::size_t k = 0; k < 20'000; ++k) {
        series.times.push_back({series.times.back().nanoseconds + 100'000'000});
        series.positions.push_back(series.positions[moving - 1] +
                                   Eigen::Vector3d(k % 2 == 0 ? 0.01 : 0.0, 0.0, 0.0));
    }
    const WindowSearch search = search_windows({series}, any_alpha(500.0), 1);
    ASSERT_EQ(search.windows.size(), 1U);
    // 500 m at 10 m/s take 50 s: twice that are 1000 samples.
    EXPECT_LT(search.steps, 1'010 * static_cast<std::int64_t>(series.times.size()));
}

/// A mean of one speed is none.
TEST(RuleSearch, AMeanWithoutTheFirstSpeedNeedsTwoMore) {
    SampleSeries series = steady(10.0, 100);
    WindowCriteria rule = over_time(0.1, SpeedDefinition::mean_n);
    EXPECT_TRUE(best_windows({series}, rule, 1).empty());
    rule.duration_s = 0.2;
    EXPECT_EQ(best_windows({series}, rule, 1).size(), 1U);
    EXPECT_EQ(best_windows({series}, over_time(0.1, SpeedDefinition::mean_n_plus_1), 1).size(), 1U);
}

TEST(RuleSearch, AnAlphaIsAsLongAsWholeSamplesAllow) {
    SampleSeries series = there_and_back(300);
    for (std::size_t k = 290; k < 330; ++k)  // twice as fast about the turn
        for (std::size_t after = k + 1; after < series.times.size(); ++after)
            series.times[after].nanoseconds -= 50'000'000;
    const auto best = best_windows({series}, alpha(500.5), 1);
    ASSERT_EQ(best.size(), 1u);
    EXPECT_NEAR(best[0].length_m, 500.0, 1e-9);
    EXPECT_NEAR(best[0].speed_m_s, 500.0 / 48.0, 1e-9);
    EXPECT_EQ(best[0].last - best[0].first, 500u);
}

TEST(RuleSearch, AnAlphaReachesBackToItsBeginning) {
    EXPECT_TRUE(alphas_begin(there_and_back(100), alpha(500.0)).empty());
    EXPECT_EQ(alphas_begin(there_and_back(100), alpha(220.0)), from_to(0, 0));
    EXPECT_TRUE(alphas_begin(there_and_back(100), alpha(221.0)).empty());
    SampleSeries series = there_and_back(300);
    series.obstacles.assign(60, 0);
    series.obstacles.resize(series.times.size(), 1);
    EXPECT_EQ(alphas_begin(series, alpha(500.0)), from_to(60, 82));
    series.bounds.assign(series.times.size(), true);
    series.bounds[60] = series.bounds[582] = false;
    EXPECT_EQ(alphas_begin(series, alpha(500.0)), from_to(61, 81));
}

TEST(RuleSearch, TheLengthOfAnAlphaIsTheRecordedPath) {
    SampleSeries series = there_and_back(300);
    for (std::size_t k = 0; k < series.times.size(); ++k)
        series.path_m.push_back(1.5 * static_cast<double>(k));
    EXPECT_EQ(alphas_begin(series, alpha(750.0)), from_to(38, 82));
}

TEST(RuleSearch, AnAlphaMayBeSlow) {
    SampleSeries slow = there_and_back(300);
    for (ElapsedTime& time : slow.times)
        time.nanoseconds *= 100;
    const auto best = best_windows({slow}, alpha(500.0), 1);
    ASSERT_EQ(best.size(), 1u);
    EXPECT_NEAR(best[0].speed_m_s, 0.1, 1e-12);
}

TEST(RuleSearch, RulesThatMeanNothingAreRefused) {
    const std::vector<SampleSeries> series{steady(10.0, 100)};
    WindowCriteria course;
    course.kind = WindowKind::course;
    WindowCriteria any_alpha = alpha(500.0);
    any_alpha.ends = WindowEnds::any;
    for (const WindowCriteria& rule :
         {course, any_alpha, over_time(3.0, SpeedDefinition::mean_n, WindowEnds::any),
          over_time(0.0, displacement), over_distance(500.0, displacement, WindowEnds::any),
          over_distance(500.0, SpeedDefinition::mean_n), over_distance(0.0, path_length)}) {
        EXPECT_THROW(best_windows(series, rule, 1), Failure);
        EXPECT_THROW(allowed_and_best(series, rule, 1), Failure);
    }
}

TEST(RuleSearch, NothingToSearchIsNothingFound) {
    EXPECT_TRUE(best_windows({}, over_time(3.0, displacement), 1).empty());
    EXPECT_TRUE(best_windows({steady(10.0, 100)}, over_time(3.0, displacement), 0).empty());
    for (const WindowEnds ends : {WindowEnds::epochs, WindowEnds::any}) {
        EXPECT_TRUE(best_windows({steady(10.0, 1)}, over_time(3.0, displacement, ends), 1).empty());
        EXPECT_TRUE(
            best_windows({steady(10.0, 1)}, over_distance(5.0, path_length, ends), 1).empty());
    }
    EXPECT_TRUE(best_windows({steady(10.0, 1)}, alpha(500.0), 1).empty());
}

// The running sums of the search are a shorter way to the same speed.
TEST(RuleSearch, HasTheSpeedsOfTheirDefinition) {
    RandomGenerator random(7);
    for (std::uint64_t number = 0; number < 20; ++number) {
        const SearchTrack track = random_track(options_of(number));
        const SampleSeries& series = track.series.front();
        const SpeedTrack samples{[&](std::size_t k) { return series.positions[k]; },
                                 [&](std::size_t k) -> Eigen::Vector3d {
                                     return {series.speeds_m_s[k], 0.0, 0.0};
                                 }};
        SampleSeries open = series;
        open.obstacles.clear();
        open.bounds.clear();
        const SummedSeries sums = summed(open, 0);
        for (int i = 0; i < 50; ++i) {
            const auto first = static_cast<std::size_t>(random.uniform() * 0.5 *
                                                        static_cast<double>(series.times.size()));
            const std::size_t last = first + 2 + static_cast<std::size_t>(i);
            if (last >= series.times.size()) continue;
            const double duration_s = series.times[last].seconds() - series.times[first].seconds();
            for (const SpeedDefinition definition :
                 {displacement, path_length, SpeedDefinition::mean_n_plus_1,
                  SpeedDefinition::mean_n})
                EXPECT_NEAR(window_between(sums, first, last, definition).value().speed_m_s,
                            speed_of(samples, {first, last}, duration_s, {definition}), 1e-9);
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
