#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"
#include "day_support.h"

// Who is ahead, and which ranks the measurement does not tell apart: worked out by hand.

namespace runcert {
namespace {

using day::attempt;
using day::without_speed;

/// "2 sail-3 [1,4]": rank, id, and how far up and down it is not told apart; "-" for nothing.
std::vector<std::string> lines_of(const std::vector<AttemptResult>& attempts) {
    const auto text = [](const std::optional<std::int64_t>& rank) {
        return rank ? std::to_string(*rank) : std::string("-");
    };
    std::vector<std::string> lines;
    for (const DayPlace& place : ranking_by("nalsa", attempts))
        lines.push_back(text(place.rank) + " " + place.id + " [" +
                        text(place.not_told_apart_up_to) + "," +
                        text(place.not_told_apart_down_to) + "]");
    return lines;
}

using Lines = std::vector<std::string>;

TEST(Ranking, OutcomeComesBeforeSpeed) {
    // The fastest is not certifiable; it has no rank.
    EXPECT_EQ(
        lines_of({attempt("a", "not_certifiable", 80.0, 0.1), attempt("b", "not_beaten", 49.0, 0.1),
                  attempt("c", "beaten", 52.0, 0.1), attempt("d", "not_proven", 55.0, 9.0),
                  without_speed("e", "not_certifiable"), attempt("f", "beaten", 53.0, 0.1)}),
        (Lines{"1 f [-,-]", "2 c [-,3]", "3 d [1,4]", "4 b [3,-]", "- a [-,-]", "- e [-,-]"}));
}

TEST(Ranking, OfEqualSpeedsTheLessUncertainIsAhead) {
    EXPECT_EQ(lines_of({attempt("a", "beaten", 52.0, 0.3), attempt("b", "beaten", 52.0, 0.1)}),
              (Lines{"1 b [-,2]", "2 a [1,-]"}));
}

TEST(Ranking, EqualInAllShareARankAndTheNextCountsThem) {
    EXPECT_EQ(lines_of({attempt("c", "beaten", 52.0, 0.1), attempt("d", "beaten", 51.0, 0.1),
                        attempt("a", "beaten", 52.0, 0.1), attempt("b", "beaten", 53.0, 0.1)}),
              (Lines{"1 b [-,-]", "2 a [-,-]", "2 c [-,-]", "4 d [-,-]"}));
}

TEST(Ranking, SpeedsAreToldApartFromTheExpandedUncertaintyOfTheirDifferenceOn) {
    const auto between = [](double difference) {
        return lines_of(
            {attempt("a", "beaten", 64.0, 0.375), attempt("b", "beaten", 64.0 - difference, 0.5)});
    };
    // sqrt(0.375^2 + 0.5^2) = 0.625.
    EXPECT_EQ(between(0.625), (Lines{"1 a [-,-]", "2 b [-,-]"}));
    EXPECT_EQ(between(0.62499), (Lines{"1 a [-,2]", "2 b [1,-]"}));
}

TEST(Ranking, NotToldApartReachesAsFarAsThereIsNoGap) {
    // Neighbours differ by 0.1, each has U = 0.11: sqrt(2) x 0.11 = 0.156 reaches one rank.
    EXPECT_EQ(lines_of({attempt("a", "beaten", 52.4, 0.11), attempt("b", "beaten", 52.3, 0.11),
                        attempt("c", "beaten", 52.2, 0.11)}),
              (Lines{"1 a [-,2]", "2 b [1,3]", "3 c [2,-]"}));
    // The third is so uncertain that it reaches both; the first two are told apart.
    EXPECT_EQ(lines_of({attempt("a", "beaten", 52.4, 0.01), attempt("b", "beaten", 52.3, 0.01),
                        attempt("c", "beaten", 52.2, 1.0)}),
              (Lines{"1 a [-,-]", "2 b [-,3]", "3 c [1,-]"}));
}

TEST(Ranking, DoesNotDependOnTheOrderInWhichAttemptsCome) {
    RandomGenerator random(7);
    std::vector<AttemptResult> attempts;
    constexpr const char* outcomes[] = {"beaten", "not_proven", "not_beaten", "not_certifiable"};
    for (int i = 0; i < 200; ++i)
        attempts.push_back(attempt("run-" + std::to_string(i), outcomes[random.next() % 4],
                                   50.0 + 0.25 * static_cast<double>(random.next() % 8),
                                   0.125 * static_cast<double>(1 + random.next() % 3)));
    const Lines expected = lines_of(attempts);
    EXPECT_EQ(expected.size(), 200U);
    for (int i = 0; i < 20; ++i) {
        for (std::size_t k = attempts.size() - 1; k > 0; --k)
            std::swap(attempts[k], attempts[random.next() % (k + 1)]);
        EXPECT_EQ(lines_of(attempts), expected);
    }
}

TEST(Ranking, CountsAreThoseOfStatesAndOutcomes) {
    std::vector<AttemptResult> attempts{attempt("a", "beaten", 52.0, 0.1),
                                        attempt("b", "not_beaten", 49.0, 0.1),
                                        without_speed("c", "not_certifiable"),
                                        {.id = "d", .source = "d.yaml", .state = "failed"},
                                        {.id = "e", .source = "e.yaml", .state = "not_processed"}};
    const DayCounts counts = counts_of(attempts);
    EXPECT_EQ(counts.attempts, 5);
    EXPECT_EQ(counts.done, 3);
    EXPECT_EQ(counts.failed, 1);
    EXPECT_EQ(counts.not_processed, 1);
    EXPECT_EQ(counts.beaten, 1);
    const OutcomeCounts outcomes = outcomes_by("nalsa", attempts);
    EXPECT_EQ(outcomes.beaten, 1);
    EXPECT_EQ(outcomes.not_proven, 0);
    EXPECT_EQ(outcomes.not_beaten, 1);
    EXPECT_EQ(outcomes.not_certifiable, 1);
    EXPECT_EQ(ranking_by("nalsa", attempts).size(), 3U);
    EXPECT_TRUE(ranking_by("fisly", attempts).empty());
}

}  // namespace
}  // namespace runcert
