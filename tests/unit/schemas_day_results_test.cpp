#include <gtest/gtest.h>

#include <string>

#include "schemas/day_results/day_results.h"
#include "store_test_support.h"

// The decision of each attempt, and the best of the day judged as the best of so many.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

DayResults day_of(const DayResult& result, const std::optional<BestOfDay>& best) {
    DayResults day;
    day.header.stage = "day";
    day.header.program_version = "1.1.0";
    day.header.source_revision = "0";
    day.day = "d";
    day.attempts = {{.id = "a", .source = "a.yaml", .state = "done", .results = {result}}};
    day.profiles = {{.profile = "nalsa", .body = "b", .title = "t", .best = best}};
    return day;
}

DayResult result() {
    return {.profile = "nalsa",
            .outcome = Outcome::beaten,
            .reason = "r",
            .probability = 0.999875,
            .level = 0.9875,
            .attempts_made = 2};
}

BestOfDay best() {
    return {.id = "a", .attempts = 7, .probability = 0.9995, .level = 0.99625, .beaten = true};
}

TEST(DayDecision, RoundTrips) {
    const DayResults back = read_day_results(write_day_results(day_of(result(), best())), "f");
    const DayResult& found = *result_by(back.attempts.at(0), "nalsa");
    EXPECT_EQ(found.probability, 0.999875);
    EXPECT_EQ(found.level, 0.9875);
    EXPECT_EQ(found.attempts_made, 2);
    EXPECT_EQ(result_by(back.attempts[0], "fisly"), nullptr);
}

TEST(DayDecision, IsAbsentWhereNothingWasDecided) {
    const DayResult undecided{
        .profile = "nalsa", .outcome = Outcome::not_certifiable, .reason = "r"};
    const DayResults back =
        read_day_results(write_day_results(day_of(undecided, std::nullopt)), "f");
    EXPECT_FALSE(back.attempts.at(0).results.at(0).probability);
    EXPECT_FALSE(back.attempts[0].results[0].level);
    EXPECT_EQ(back.attempts[0].results[0].attempts_made, 1);
    EXPECT_FALSE(back.profiles.at(0).best);
}

TEST(DayBest, RoundTrips) {
    for (const bool beaten : {true, false}) {
        BestOfDay before = best();
        before.beaten = beaten;
        const BestOfDay back = read_day_results(write_day_results(day_of(result(), before)), "f")
                                   .profiles[0]
                                   .best.value();
        EXPECT_EQ(back.id, "a");
        EXPECT_EQ(back.attempts, 7);
        EXPECT_EQ(back.probability, 0.9995);
        EXPECT_EQ(back.level, 0.99625);
        EXPECT_EQ(back.beaten, beaten);
    }
}

/// The level of the best of many is told from that of the best of one more.
TEST(DayBest, LevelsAreWrittenToNineDecimals) {
    BestOfDay exact = best();
    DayResult one = result();
    one.level = exact.level = 1.0 - 0.025 / 3.0;
    const DayResults back = read_day_results(write_day_results(day_of(one, exact)), "f");
    EXPECT_EQ(back.profiles.at(0).best->level, 0.991666667);
    EXPECT_EQ(back.attempts.at(0).results.at(0).level, 0.991666667);
}

TEST(DayBest, ImpossibleFiguresAreRefused) {
    const std::string text = write_day_results(day_of(result(), best()));
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"probability: 0.999875", "probability: 1.5", "1.5 is above 1"},
        {"probability: 0.999875", "probability: -0.5", "-0.5 is below 0"},
        {"level: 0.9875", "level: 1.5", "1.5 is above 1"},
        {"attempts_made: 2", "attempts_made: 0", "0 is below 1"},
        {"attempts: 7", "attempts: 0", "0 is below 1"},
        {"probability: 0.9995", "probability: 1.5", "1.5 is above 1"},
        {"level: 0.99625", "level: -0.5", "-0.5 is below 0"},
        {"beaten: true", "beaten: maybe", "neither true nor false"},
        {"      id: a\n      attempts: 7\n", "      attempts: 7\n", "the key \"id\" is missing"},
        {"      attempts: 7\n", "", "the key \"attempts\" is missing"},
        {"      probability: 0.9995\n", "", "the key \"probability\" is missing"},
        {"      level: 0.99625\n", "", "the key \"level\" is missing"},
        {"      beaten: true\n", "", "the key \"beaten\" is missing"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_day_results(replaced(text, c.from, c.to), "f"); });
        EXPECT_TRUE(said.contains(c.said)) << c.from << "\n" << said.problem;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
