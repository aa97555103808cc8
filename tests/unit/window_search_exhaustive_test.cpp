#include <gtest/gtest.h>

#include <tuple>

#include "window_exhaustive_search.h"
#include "witness/certifiable.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::alpha;
using test::any_alpha;
using test::displacement;
using test::exactly;
using test::ExhaustiveSearch;
using test::options_of;
using test::over_distance;
using test::over_time;
using test::path_length;
using test::random_track;
using test::SearchTrack;

void expect_encloses(const SampleSeries& series, const FoundWindow& window) {
    ASSERT_LT(window.first, window.last);
    ASSERT_LT(window.last, series.times.size());
    EXPECT_LE(series.times[window.first], window.start);
    EXPECT_LT(window.start, series.times[window.first + 1]);
    EXPECT_LT(series.times[window.last - 1], window.end);
    EXPECT_LE(window.end, series.times[window.last]);
}

struct Compared {
    std::size_t windows = 0;
    std::size_t ties = 0;  ///< tracks with windows that are equally fast but for rounding
};

/// The search's windows are those of the exhaustive one, up to a tie: with both ends in stands, a
/// window may be moved.
Compared expect_same(const SearchTrack& track, const WindowCriteria& rule, std::size_t count) {
    const auto found = best_windows(track.series, rule, count);
    const auto expected = ExhaustiveSearch(track, rule).best(count);
    EXPECT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < std::min(found.size(), expected.size()); ++k) {
        const double difference_m_s = found[k].speed_m_s - expected[k].speed_m_s;
        if (found[k].start != expected[k].start && std::abs(difference_m_s) < 1e-12) return {k, 1};
        EXPECT_EQ(found[k].series, expected[k].series);
        EXPECT_EQ(found[k].start, expected[k].start);
        EXPECT_EQ(found[k].end, expected[k].end);
        EXPECT_EQ(found[k].first, expected[k].first);
        EXPECT_EQ(found[k].last, expected[k].last);
        EXPECT_NEAR(found[k].speed_m_s, expected[k].speed_m_s, 1e-9);
        EXPECT_NEAR(found[k].length_m, expected[k].length_m, 1e-9 * expected[k].length_m);
        expect_encloses(track.series[found[k].series], found[k]);
    }
    return {expected.size(), 0};
}

struct NamedRule {
    const char* name;
    WindowCriteria rule;
    std::size_t count = 1;
};

void PrintTo(const NamedRule& rule, std::ostream* out) {
    *out << rule.name;
}

class AgainstExhaustive : public testing::TestWithParam<NamedRule> {};

TEST_P(AgainstExhaustive, TheSameWindowsOn200RandomTracks) {
    std::size_t windows = 0, ties = 0;
    for (std::uint64_t number = 0; number < 200 && !HasFailure(); ++number) {
        SCOPED_TRACE(number);
        const Compared compared =
            expect_same(random_track(options_of(number)), GetParam().rule, GetParam().count);
        windows += compared.windows;
        ties += compared.ties;
    }
    EXPECT_LE(ties, 1u);
    EXPECT_GT(windows, 40 * GetParam().count) << "too few to say anything";
}

INSTANTIATE_TEST_SUITE_P(
    RuleSearch, AgainstExhaustive,
    testing::Values(NamedRule{"displacement_2_s", over_time(2.0, displacement)},
                    NamedRule{"displacement_3_s", over_time(3.0, displacement)},
                    NamedRule{"path_3_s", over_time(3.0, path_length)},
                    NamedRule{"exactly_3_s", exactly(3.0, displacement)},
                    NamedRule{"mean_n_10_s", over_time(10.0, SpeedDefinition::mean_n)},
                    NamedRule{"mean_n_plus_1_3_s", over_time(3.0, SpeedDefinition::mean_n_plus_1)},
                    NamedRule{"five_of_10_s", over_time(10.0, SpeedDefinition::mean_n_plus_1), 5},
                    NamedRule{"five_displacements_of_10_s", over_time(10.0, displacement), 5},
                    NamedRule{"any_3_s", over_time(3.0, displacement, WindowEnds::any), 3},
                    NamedRule{"any_path_of_10_s", over_time(10.0, path_length, WindowEnds::any), 5},
                    NamedRule{"path_of_500_m", over_distance(500.0, path_length)},
                    NamedRule{"path_of_1852_m", over_distance(1852.0, path_length)},
                    NamedRule{"straight_250_m", over_distance(250.0, displacement)},
                    NamedRule{"five_straight_100_m", over_distance(100.0, displacement), 5},
                    NamedRule{"any_500_m", over_distance(500.0, path_length, WindowEnds::any), 3},
                    NamedRule{"alpha_500", alpha(500.0)},
                    NamedRule{"any_alpha_500", any_alpha(500.0)},
                    NamedRule{"any_alpha_250", any_alpha(250.0)},
                    NamedRule{"three_alphas_of_250", alpha(250.0), 3}),
    [](const auto& instance) { return std::string(instance.param.name); });

/// No window at an instant of a fine grid beats those found, of those that do not overlap them.
void expect_unbeaten(const SearchTrack& track, const WindowCriteria& rule, std::size_t count) {
    const auto found = best_windows(track.series, rule, count);
    const ExhaustiveSearch exhaustive(track, rule);
    for (std::size_t s = 0; s < track.series.size(); ++s) {
        const auto& times = track.series[s].times;
        for (auto at = times.front().nanoseconds; at < times.back().nanoseconds; at += 7'310'417) {
            const auto window = exhaustive.window_from(s, static_cast<long double>(at));
            if (!window) continue;
            std::vector<FoundWindow> before;
            for (const FoundWindow& one : found) {
                if (ExhaustiveSearch::overlaps(*window, before)) break;
                EXPECT_LE(window->speed_m_s, one.speed_m_s + 1e-9) << at;
                before.push_back(one);
            }
        }
    }
}

TEST(RuleSearch, NoInstantBetweenEpochsIsFaster) {
    for (std::uint64_t number = 0; number < 12; ++number) {
        SCOPED_TRACE(number);
        const SearchTrack track = random_track(options_of(number));
        expect_unbeaten(track, over_time(2.0, displacement, WindowEnds::any), 3);
        expect_unbeaten(track, over_time(3.05, path_length, WindowEnds::any), 3);
        expect_unbeaten(track, over_distance(100.0, path_length, WindowEnds::any), 3);
    }
}

/// A trajectory of one arc for each series, as the stage reads it.
TrajectoryTable trajectory_of(const SearchTrack& track) {
    TrajectoryTable table;
    table.facts.nominal_interval_s = track.interval_s;
    for (std::size_t s = 0; s < track.series.size(); ++s)
        for (std::size_t k = 0; k < track.series[s].times.size(); ++k) {
            TrajectoryEpoch& row = table.rows.emplace_back();
            row.time = track.series[s].times[k];
            row.east_m = track.series[s].positions[k].x();
            row.north_m = track.series[s].positions[k].y();
            row.speed_m_s = track.series[s].speeds_m_s[k];
            row.arc = static_cast<std::int64_t>(s) + 1;
            row.usable = !track.obstacle[s][k];
        }
    return table;
}

TEST(RuleSearch, AllowsTheWindowsThatCanBeCertified) {
    for (std::uint64_t number = 0; number < 20; ++number) {
        test::TrackOptions options = options_of(number);
        options.vertical = false;
        SearchTrack track = random_track(options);
        for (std::size_t s = 0; s < track.series.size(); ++s) {
            track.series[s].bounds.clear();
            for (const bool obstacle : track.obstacle[s])
                track.series[s].bounds.push_back(!obstacle);
        }
        const TrajectoryTable table = trajectory_of(track);
        const auto certifiable = certifiable_windows(table, arcs_in(table), 3.0, 0.001);
        const auto allowed = allowed_and_best(track.series, over_time(3.0, displacement), 1).all;
        std::size_t i = 0;
        for (std::size_t arc = 0; arc < certifiable.size(); ++arc)
            for (const EpochPair& window : certifiable[arc]) {
                ASSERT_LT(i, allowed.size());
                EXPECT_EQ(allowed[i].series, arc);
                EXPECT_EQ(allowed[i].first, window.first);
                EXPECT_EQ(allowed[i].last, window.last);
                ++i;
            }
        EXPECT_EQ(i, allowed.size());
        EXPECT_GT(i, 100u);
    }
}

TEST(RuleSearch, AllowedWindowsHoldTheBest) {
    const SearchTrack track = random_track(options_of(1));
    for (const WindowCriteria& rule :
         {over_time(3.0, displacement), over_time(3.0, displacement, WindowEnds::any),
          over_distance(500.0, path_length), over_distance(100.0, path_length, WindowEnds::any),
          alpha(500.0)}) {
        const auto all = allowed_and_best(track.series, rule, 1).all;
        const auto best = best_windows(track.series, rule, 1);
        ASSERT_EQ(best.size(), 1u);
        const auto fastest = std::min_element(all.begin(), all.end(), preferred);
        EXPECT_EQ(fastest->speed_m_s, best[0].speed_m_s);
        EXPECT_EQ(fastest->start, best[0].start);
        EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const auto& a, const auto& b) {
            return std::tie(a.series, a.first) < std::tie(b.series, b.first);
        }));
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
