#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <tuple>

#include "core/failure.h"
#include "core/random.h"
#include "stages/window/course_windows.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A line across a course that goes north, 100 m wide, this far north.
SurveyedLine line_at(double north_m) {
    return {{-50.0, north_m}, {50.0, north_m}};
}

struct Point {
    double east_m = 0.0;
    double north_m = 0.0;
};

/// A track with a sample each second, the first at `from_s`.
SampleSeries track_of(const std::vector<Point>& points, std::int64_t from_s = 0) {
    SampleSeries series;
    for (const Point& point : points) {
        series.times.push_back(
            {(from_s + static_cast<std::int64_t>(series.times.size())) * 1'000'000'000});
        series.positions.emplace_back(point.east_m, point.north_m, 0.0);
    }
    return series;
}

/// The same, due north and south through these distances.
SampleSeries north_through(const std::vector<double>& norths_m, std::int64_t from_s = 0) {
    std::vector<Point> points;
    points.reserve(norths_m.size());
    for (const double north_m : norths_m)
        points.push_back({0.0, north_m});
    return track_of(points, from_s);
}

TEST(Crossings, AStraightCourseIsCrossedAtAKnownTime) {
    // 20 m/s from 5 m before the line: 0.25 s after the first sample.
    const auto found = crossings({north_through({-5.0, 15.0, 35.0})}, line_at(0.0));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].series, 0u);
    EXPECT_EQ(found[0].after, 0u);
    EXPECT_EQ(found[0].time, ElapsedTime{250'000'000});
    EXPECT_EQ(found[0].fraction, 0.25);
    EXPECT_TRUE(found[0].forward);
    EXPECT_EQ(found[0].position, Eigen::Vector2d(0.0, 0.0));
}

TEST(Crossings, TheTimeIsRoundedToTheNanosecond) {
    const auto found = crossings({north_through({-1.0, 2.0})}, line_at(0.0));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].time, ElapsedTime{333'333'333});
}

TEST(Crossings, ADiagonalIsCrossedWhereBothLinesMeet) {
    // From (-3, -1) to (5, 3), and a line from (0, 4) to (4, -4): they meet where
    // x = -3 + 8 f, y = -1 + 4 f, y = 4 - 2 x, so f = 11/20.
    const auto found = crossings({track_of({{-3.0, -1.0}, {5.0, 3.0}})}, {{0.0, 4.0}, {4.0, -4.0}});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].fraction, 0.55, 1e-15);
    EXPECT_EQ(found[0].time, ElapsedTime{550'000'000});
    EXPECT_NEAR(found[0].position.x(), 1.4, 1e-14);
    EXPECT_NEAR(found[0].position.y(), 1.2, 1e-14);
    EXPECT_TRUE(found[0].forward) << "to the east, with the left end in the north";
}

TEST(Crossings, BackwardIsAgainstTheCourseAndExchangedEndsAreToo) {
    const SampleSeries south = north_through({5.0, -5.0});
    EXPECT_FALSE(crossings({south}, line_at(0.0)).at(0).forward);
    EXPECT_TRUE(crossings({south}, {line_at(0.0).right, line_at(0.0).left}).at(0).forward);
}

TEST(Crossings, ASampleOnTheLineCountsOnce) {
    const auto found = crossings({north_through({-10.0, 0.0, 10.0, 20.0})}, line_at(0.0));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].after, 1u);
    EXPECT_EQ(found[0].fraction, 0.0);
    EXPECT_EQ(found[0].time, ElapsedTime{1'000'000'000});
}

TEST(Crossings, AStandOnTheLineCountsOnceWhenItIsReached) {
    const auto found = crossings({north_through({-10.0, 0.0, 0.0, 0.0, 10.0})}, line_at(0.0));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].time, ElapsedTime{1'000'000'000});
}

TEST(Crossings, ATouchIsNoCrossing) {
    EXPECT_TRUE(crossings({north_through({-10.0, 0.0, -10.0})}, line_at(0.0)).empty());
    EXPECT_TRUE(crossings({north_through({10.0, 0.0, 0.0, 10.0})}, line_at(0.0)).empty());
    EXPECT_TRUE(crossings({north_through({0.0, 10.0})}, line_at(0.0)).empty()) << "begins on it";
    EXPECT_TRUE(crossings({north_through({-10.0, 0.0})}, line_at(0.0)).empty()) << "ends on it";
}

TEST(Crossings, BeyondTheEndsOfTheGateIsNoCrossing) {
    const auto at = [](double east_m) {
        return crossings({track_of({{east_m, -1.0}, {east_m, 1.0}})}, line_at(0.0)).size();
    };
    EXPECT_EQ(at(-50.001), 0u);
    EXPECT_EQ(at(-50.0), 1u);
    EXPECT_EQ(at(50.0), 1u);
    EXPECT_EQ(at(50.001), 0u);
}

TEST(Crossings, AGapIsNotCrossed) {
    EXPECT_TRUE(
        crossings({north_through({-20.0, -10.0}), north_through({10.0, 20.0}, 5)}, line_at(0.0))
            .empty());
}

TEST(Crossings, AGateWithoutWidthIsRefused) {
    EXPECT_THROW(crossings({north_through({-1.0, 1.0})}, {{3.0, 4.0}, {3.0, 4.0}}), Failure);
}

/// Each step of a track against the gate, as two segments by their parameters.
TEST(Crossings, AreThoseOfEverySegmentOfRandomTracks) {
    std::size_t all = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        RandomGenerator random(seed);
        const auto point = [&] { return Eigen::Vector2d(random.normal(), random.normal()); };
        const SurveyedLine gate{point(), point()};
        SampleSeries series;
        for (std::int64_t k = 0; k < 100; ++k) {
            series.times.push_back({k * 1'000'000'000});
            const Eigen::Vector2d at = point();
            series.positions.emplace_back(at.x(), at.y(), random.normal());
        }
        const auto found = crossings({series}, gate);
        std::size_t next = 0;
        for (std::size_t k = 0; k + 1 < 100; ++k) {
            const Eigen::Vector2d from = series.positions[k].head<2>();
            const Eigen::Vector2d to = series.positions[k + 1].head<2>();
            Eigen::Matrix2d sides;
            sides << to - from, gate.left - gate.right;
            const Eigen::Vector2d parts = sides.inverse() * (gate.left - from);
            if (parts.minCoeff() < 0.0 || parts.maxCoeff() > 1.0) continue;
            ASSERT_LT(next, found.size());
            EXPECT_EQ(found[next].after, k);
            EXPECT_NEAR(found[next].fraction, parts[0], 1e-9);
            EXPECT_NEAR((found[next].position - (1.0 - parts[0]) * from - parts[0] * to).norm(),
                        0.0, 1e-8);
            // The left end is to the left of one who goes forward.
            const Eigen::Vector2d way = to - from, left = gate.left - gate.right;
            EXPECT_EQ(found[next].forward, way.x() * left.y() - way.y() * left.x() > 0.0);
            ++next;
        }
        EXPECT_EQ(next, found.size());
        all += next;
    }
    EXPECT_GT(all, 1000u);
}

/// The passages of a course from 0 m to 500 m north.
std::vector<Passage> passages_of(const std::vector<SampleSeries>& series) {
    return passages(series, line_at(0.0), line_at(500.0));
}

std::string why_none(const std::vector<SampleSeries>& series) {
    return why_no_passage(series, line_at(0.0), line_at(500.0));
}

TEST(Passages, ARunFromLineToLine) {
    // 500 m in samples 40 m apart, from 10 m before the start line.
    std::vector<double> norths_m;
    for (int k = 0; k < 15; ++k)
        norths_m.push_back(-10.0 + 40.0 * k);
    const auto found = passages_of({north_through(norths_m)});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].start.time, ElapsedTime{250'000'000});
    EXPECT_EQ(found[0].finish.time, ElapsedTime{12'750'000'000});
    EXPECT_EQ(found[0].finish.after, 12u);
    EXPECT_EQ(found[0].refusal, "");
    EXPECT_EQ(why_none({north_through(norths_m)}), "");
}

TEST(Passages, AReturnThroughBothLinesIsANewRun) {
    const auto found = passages_of({north_through({-10, 510, -10, 510})});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].refusal, "");
    EXPECT_EQ(found[1].refusal, "");
    EXPECT_LT(found[0].finish.time, found[1].start.time);
}

TEST(Passages, AReturnAroundTheLinesIsANewRun) {
    const auto found =
        passages_of({track_of({{0, -10}, {0, 510}, {90, 510}, {90, -10}, {0, -10}, {0, 510}})});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].refusal, "");
    EXPECT_EQ(found[1].refusal, "");
}

TEST(Passages, AStartLineCrossedBackAndAgainIsRefused) {
    const auto found = passages_of({north_through({-10, 10, -10, 10, 510})});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].start.time, ElapsedTime{2'500'000'000}) << "the one before the finish";
    EXPECT_EQ(found[0].refusal,
              "The start line was crossed 3 times before the finish line, at 0.500 s, 1.500 s and "
              "2.500 s: it is not known which crossing began the run.");
}

TEST(Passages, AStartLineCrossedAgainFromAroundItsEndIsRefused) {
    const auto found = passages_of(
        {track_of({{0, -10}, {0, 10}, {90, 10}, {90, -10}, {0, -10}, {0, 10}, {0, 510}})});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].refusal,
              "The start line was crossed 2 times before the finish line, at 0.500 s and 4.500 s: "
              "it is not known which crossing began the run.");
}

TEST(Passages, ComingBackOverTheStartLineBeforeARunIsNoRefusal) {
    const auto found = passages_of({north_through({10, -10, 510})});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].refusal, "");
}

TEST(Passages, AFinishLineCrossedAgainIsRefused) {
    const auto found = passages_of({north_through({-10, 490, 510, 490, 510})});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].finish.time, ElapsedTime{1'500'000'000}) << "the first";
    EXPECT_EQ(found[0].refusal,
              "The finish line was crossed 3 times after the start line, at 1.500 s, 2.500 s and "
              "3.500 s: it is not known which crossing ended the run.");
}

TEST(Passages, ALineAlongWhichTheTrackRunsHasNoCertainCrossing) {
    const auto across = [](double step_m) {
        return passages_of({north_through({-10.0, -0.5 * step_m, 0.5 * step_m, 250.0, 510.0})});
    };
    ASSERT_EQ(across(0.04).size(), 1u);
    EXPECT_NE(across(0.04)[0].refusal.find("crosses the start line, at 1.500 s, it runs along"),
              std::string::npos)
        << across(0.04)[0].refusal;
    EXPECT_EQ(across(0.06)[0].refusal, "");
    const auto standing = passages_of({north_through({-10.0, 250.0, 499.99, 500.01, 510.0})});
    ASSERT_EQ(standing.size(), 1u);
    EXPECT_NE(standing[0].refusal.find("crosses the finish line"), std::string::npos);
}

TEST(Passages, BothRefusalsAreStated) {
    const auto found = passages_of({north_through({-10, 10, -10, 490, 510, 490, 510, -10})});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].refusal.find("began the run. The finish line was crossed 3 times"),
              std::string::npos);
}

TEST(Passages, AFinishInAnotherSeriesIsNoPassage) {
    const std::vector<SampleSeries> series{north_through({-10, 10}), north_through({490, 510}, 9)};
    EXPECT_TRUE(passages_of(series).empty());
    EXPECT_EQ(why_none(series),
              "the track crosses the start line once, but the finish line after it only beyond a "
              "gap in the positions");
}

TEST(Passages, AStartInAnotherSeriesDoesNotMakeARunAmbiguous) {
    const auto found = passages_of(
        {north_through({-10, 10}), north_through({-10, 510}, 9), north_through({490, 510}, 20)});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].start.series, 1u);
    EXPECT_EQ(found[0].refusal, "");
}

TEST(Passages, OneGateMakesLaps) {
    std::vector<Point> circle;
    for (int k = 0; k < 25; ++k)
        circle.push_back(
            {-100.0 + 100.0 * std::cos(0.6 * k - 0.3), 100.0 * std::sin(0.6 * k - 0.3)});
    const auto found = passages({track_of(circle)}, line_at(0.0), line_at(0.0));
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].finish.time, found[1].start.time);
    EXPECT_EQ(found[0].refusal, "");
}

TEST(Passages, WhyThereIsNone) {
    EXPECT_EQ(why_none({north_through({10, 510})}), "the track never crosses the start line");
    EXPECT_EQ(why_none({}), "the track never crosses the start line");
    EXPECT_EQ(why_none({north_through({-10, 10, -10, 10})}),
              "the track crosses the start line 2 times but never the finish line after it");
    EXPECT_EQ(why_none({north_through({510, -10})}),
              "the track crosses the start line only against the course's direction, once (are "
              "left and right exchanged?)");
    EXPECT_EQ(why_no_passage({north_through({-10, 510})}, line_at(0.0),
                             {line_at(500.0).right, line_at(500.0).left}),
              "the track crosses the finish line only against the course's direction, once (are "
              "left and right exchanged?)");
    EXPECT_EQ(why_none({track_of(
                  {{0, -10}, {0, 10}, {0, -10}, {90, -10}, {90, 490}, {0, 490}, {0, 510}})}),
              "the track crosses the start line once, but always crosses a line against the "
              "course's direction before it reaches the finish line");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
