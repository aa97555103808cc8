#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "schemas/attempt/attempt.h"
#include "schemas_attempt_support.h"
#include "store_test_support.h"

// Claims of an attempt that somebody must answer for, and how many attempts were made.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

const std::string least = R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa]
)";

TEST(AttemptClaims, AreRead) {
    const Attempt attempt = read_attempt(
        replaced(replaced(least, "r.csv}", "r.csv, solution: float, time_source: satellites}"),
                 "id: a\n", "id: a\nattempts_made: 40\n"),
        "f");
    EXPECT_EQ(attempt.receivers.at(0).solution, "float");
    EXPECT_EQ(attempt.receivers.at(0).time_source, "satellites");
    EXPECT_EQ(attempt.attempts_made, 40);
}

TEST(AttemptClaims, AreNoneWhereNothingStands) {
    const Attempt attempt = read_attempt(least, "f");
    EXPECT_EQ(attempt.attempts_made, 1);
    EXPECT_EQ(attempt.receivers.at(0).solution, "");
    EXPECT_EQ(attempt.receivers.at(0).time_source, "");
    EXPECT_EQ(parameters_of(attempt, "window")->at("clock_rate_bound"), 0.0001);
    EXPECT_TRUE(attempt.overrides.empty());
    const Attempt null =
        read_attempt(replaced(replaced(least, "r.csv}", "r.csv, solution: null, time_source: ~}"),
                              "id: a\n", "id: a\nattempts_made: null\n"),
                     "f");
    EXPECT_EQ(null.attempts_made, 1);
    EXPECT_EQ(null.receivers.at(0).solution, "");
    EXPECT_EQ(null.receivers.at(0).time_source, "");
}

TEST(AttemptClaims, AreThoseOfEachReceiver) {
    for (const char* kind : {"fixed", "float", "ppp", "dgps", "sbas", "single", "dead_reckoning"}) {
        const Attempt attempt = read_attempt(
            replaced(least, "r.csv}\n",
                     std::string("r.csv, solution: ") + kind +
                         "}\n  - {id: secondary, recording: s, time_source: satellites}\n"),
            "f");
        EXPECT_EQ(attempt.receivers.at(0).solution, kind);
        EXPECT_EQ(attempt.receivers.at(0).time_source, "");
        EXPECT_EQ(attempt.receivers.at(1).solution, "");
        EXPECT_EQ(attempt.receivers.at(1).time_source, "satellites");
    }
}

TEST(AttemptClaims, TheClocksRateMayBeBounded) {
    const Attempt attempt = read_attempt(
        replaced(least, "[nalsa]", "[nalsa]\nparameters: {window: {clock_rate_bound: 0.01}}"), "f");
    EXPECT_EQ(parameters_of(attempt, "window")->at("clock_rate_bound"), 0.01);
    EXPECT_EQ(attempt.overrides, std::vector<std::string>{"window.clock_rate_bound"});
}

TEST(AttemptClaims, BadValuesAreNamedWithTheirPlace) {
    const test::BadAttempt cases[] = {
        {"r.csv}", "r.csv, solution: rtk}", "f:5:47",
         "\"rtk\" is not one of fixed, float, ppp, dgps, sbas, single, dead_reckoning"},
        {"r.csv}", "r.csv, solution: unknown}", "f:5:47", "\"unknown\" is not one of"},
        {"r.csv}", "r.csv, solution: none}", "f:5:47", "\"none\" is not one of"},
        {"r.csv}", "r.csv, solution: 1}", "f:5:47", "\"1\" is not one of"},
        {"r.csv}", "r.csv, solution: [fixed]}", "f:5:47", "is a list, not text"},
        {"r.csv}", "r.csv, time_source: gps}", "f:5:50", "\"gps\" is not one of satellites"},
        {"r.csv}", "r.csv, time_source: unknown}", "f:5:50", "\"unknown\" is not one of"},
        {"id: a\n", "id: a\nattempts_made: 0\n", "f:3:16", "0 is below 1"},
        {"id: a\n", "id: a\nattempts_made: -3\n", "f:3:16", "-3 is below 1"},
        {"id: a\n", "id: a\nattempts_made: 2.5\n", "f:3:16", "not a whole number"},
        {"id: a\n", "id: a\nattempts_made: many\n", "f:3:16", "\"many\" is not a whole number"},
        {"id: a\n", "id: a\nattempts_made: 100001\n", "f:3:16", "above 100000"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {clock_rate_bound: 0}}", "f:7:41",
         "below 0.0001"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {clock_rate_bound: 0.2}}", "f:7:41",
         "above 0.1"},
    };
    test::expect_named(least, cases);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
