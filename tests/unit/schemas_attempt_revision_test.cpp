#include <gtest/gtest.h>

#include <string>

#include "files_test_support.h"
#include "schemas/attempt/attempt.h"

// What revision 1.1 of an attempt added.

namespace runcert {
namespace {

using test::failure_of;
using test::replaced;

/// The least that an attempt says, of both revisions.
const std::string least = R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa]
)";
const std::string least_1_1 = replaced(least, "attempt/1.0", "attempt/1.1");

TEST(AttemptRevision, BothAreReadAlikeWhereTheySayTheSame) {
    const Attempt first = read_attempt(least, "f");
    const Attempt second = read_attempt(least_1_1, "f");
    EXPECT_EQ(first.parameters, second.parameters);
    EXPECT_TRUE(second.overrides.empty());
    EXPECT_FALSE(second.receivers.at(0).rotation_bound_deg);
}

TEST(AttemptRevision, WhatIsNewHasItsDefault) {
    const Attempt attempt = read_attempt(least, "f");
    const auto smooth = attempt.parameters.at("smooth");
    EXPECT_EQ(smooth.at("noise"), "fitted");
    EXPECT_EQ(smooth.at("motion_model"), "auto");
    EXPECT_EQ(smooth.at("error_time_min_s"), 0.5);
    EXPECT_EQ(smooth.at("error_time_max_s"), 10);
    EXPECT_EQ(smooth.at("robust_scale"), 2.0);
    const auto window = attempt.parameters.at("window");
    EXPECT_EQ(window.at("seed"), 1);
    EXPECT_EQ(window.at("selection_samples"), 500);
    EXPECT_EQ(window.at("monte_carlo_trials_max"), 1'000'000);
    EXPECT_EQ(window.at("plane_scale_bound"), 0.001);
}

TEST(AttemptRevision, ALaterFieldInAnEarlierFileNamesTheRevisionItNeeds) {
    const struct {
        std::string from, to, where, field;
    } cases[] = {
        {"r.csv}", "r.csv, lever_arm_m: {forward: 0, right: 0, down: 1}, rotation_bound_deg: 5}",
         "f:5:103", "receivers[0].rotation_bound_deg"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {noise: stated}}", "f:7:30",
         "parameters.smooth.noise"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {duration_tolerance_s: 0.01, seed: null}}",
         "f:7:57", "parameters.window.seed"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_attempt(replaced(least, c.from, c.to), "f"); });
        EXPECT_EQ(said.where, c.where) << c.to;
        EXPECT_TRUE(said.contains(c.field + ": the field needs revision 1.1 of the schema attempt; "
                                            "the file follows attempt/1.0. Let the file say "
                                            "attempt/1.1, or remove the field"))
            << said.problem << said.remedy;
        EXPECT_NO_THROW(read_attempt(replaced(least_1_1, c.from, c.to), "f")) << c.to;
    }
    // No field of any revision: not known, whatever a path might look like.
    EXPECT_TRUE(failure_of([&] {
                    read_attempt(
                        replaced(least, "[nalsa]", "[nalsa]\nparameters: {smooth.noise: a}"), "f");
                }).contains("unknown key \"smooth.noise\""));
}

TEST(AttemptRevision, BadInputIsNamedWithItsPlace) {
    const struct {
        std::string from, to, where, said;
    } cases[] = {
        {"r.csv}", "r.csv, rotation_bound_deg: 5}", "f:5:57",
         "the craft's rotation is bounded, but no lever arm is given for it to act on. Add "
         "lever_arm_m"},
        {"r.csv}", "r.csv, lever_arm_m: {forward: 0, right: 0, down: 1}, rotation_bound_deg: 181}",
         "f:5:103", "181 is above 180 deg"},
        {"r.csv}", "r.csv, lever_arm_m: {forward: 0, right: 0, down: 1}, rotation_bound_deg: -1}",
         "f:5:103", "-1 is below 0 deg"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {noise: guessed}}", "f:7:30",
         "\"guessed\" is not one of fitted, stated"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {motion_model: jerk}}", "f:7:37",
         "\"jerk\" is not one of auto, constant_acceleration, singer"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {robust_scale: 0.4}}", "f:7:37", "below 0.5"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {error_time_min_s: 10}}", "f:7:41",
         "from 10 s to 10 s. Give error_time_max_s above error_time_min_s"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {error_time_min_s: 2, error_time_max_s: 1}}",
         "f:7:62", "from 2 s to 1 s"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {seed: -1}}", "f:7:29", "-1 is below 0"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {seed: 1.5}}", "f:7:29", "not a whole number"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {selection_samples: 99}}", "f:7:42",
         "99 is below 100"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {monte_carlo_trials_max: 9999}}", "f:7:47",
         "9999 is below 10000"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {plane_scale_bound: 0.2}}", "f:7:42",
         "0.2 is above 0.1"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_attempt(replaced(least_1_1, c.from, c.to), "f"); });
        EXPECT_EQ(said.where, c.where) << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem << ". " << said.remedy;
    }
}

}  // namespace
}  // namespace runcert
