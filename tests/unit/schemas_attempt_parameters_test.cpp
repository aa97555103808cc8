#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "schemas/attempt/attempt.h"
#include "schemas_attempt_support.h"
#include "store_test_support.h"

// Parameters of an attempt: their defaults and ranges.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

/// The least that an attempt says.
const std::string least = R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa]
)";

TEST(AttemptParameters, HaveTheirDefaults) {
    const Attempt attempt = read_attempt(least, "f");
    const auto smooth = *parameters_of(attempt, "smooth");
    EXPECT_EQ(smooth.at("noise"), "fitted");
    EXPECT_EQ(smooth.at("motion_model"), "auto");
    EXPECT_EQ(smooth.at("error_time_min_s"), 0.5);
    EXPECT_EQ(smooth.at("error_time_max_s"), 10);
    EXPECT_EQ(smooth.at("robust_scale"), 2.0);
    const auto window = *parameters_of(attempt, "window");
    EXPECT_EQ(window.at("seed"), 1);
    EXPECT_EQ(window.at("selection_samples"), 500);
    EXPECT_EQ(window.at("monte_carlo_trials_max"), 1'000'000);
    EXPECT_EQ(window.at("plane_scale_bound"), 0.001);
    EXPECT_EQ(window.at("height_bound_m"), 150);
}

TEST(AttemptHeights, AreThoseOfPlacesWhereCraftOfTheClassRun) {
    const auto typed = [](const std::string& craft, double height_m) {
        return replaced(replaced(least, "class: board", "class: " + craft), "recording: r.csv",
                        fmt::format("recording: r.csv, height_m: {:g}", height_m));
    };
    struct Limits {
        const char* craft;
        double lowest_m, highest_m;
    };
    for (const Limits& of : {Limits{"land-yacht", -450, 5200},
                             {"ice-yacht", -120, 5200},
                             {"sail-boat", -450, 5000},
                             {"board", -450, 5000},
                             {"car", -450, 6000},
                             {"skydiver", -1000, 20000},
                             {"other", -1000, 20000}}) {
        SCOPED_TRACE(of.craft);
        for (const double height_m : {of.lowest_m, 0.0, of.highest_m})
            EXPECT_NO_THROW(read_attempt(typed(of.craft, height_m), "f")) << height_m;
        for (const double height_m : {of.lowest_m - 1.0, of.highest_m + 1.0}) {
            const auto said = failure_of([&] { read_attempt(typed(of.craft, height_m), "f"); });
            EXPECT_EQ(said.where, "f:5:47") << height_m;
            EXPECT_FALSE(said.remedy.empty());
        }
    }
    const auto said = failure_of([&] { read_attempt(typed("land-yacht", 20000), "f"); });
    EXPECT_TRUE(
        said.contains("no land-yacht runs at a height of 20000 m: it is from -450 m to 5200 m"))
        << said.problem;
}

TEST(AttemptHeights, MayBeAllowedMoreForAndNeverLess) {
    const auto bound = [](const std::string& metres) {
        return least + "parameters: {window: {height_bound_m: " + metres + "}}\n";
    };
    EXPECT_EQ(parameters_of(read_attempt(bound("300"), "f"), "window")->at("height_bound_m"), 300);
    EXPECT_TRUE(failure_of([&] { read_attempt(bound("149"), "f"); }).contains("149 is below 150"));
}

TEST(AttemptParameters, AKeyIsNoPath) {
    EXPECT_TRUE(failure_of([&] {
                    read_attempt(
                        replaced(least, "[nalsa]", "[nalsa]\nparameters: {smooth.noise: a}"), "f");
                }).contains("unknown key \"smooth.noise\""));
}

TEST(AttemptParameters, BadInputIsNamedWithItsPlace) {
    const test::BadAttempt cases[] = {
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
         "error_time_max_s is 10 s, which is not above error_time_min_s, 10 s. Give "
         "error_time_max_s above error_time_min_s"},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {error_time_min_s: 2, error_time_max_s: 1}}",
         "f:7:62", "which is not above error_time_min_s, 2 s"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {seed: -1}}", "f:7:29", "-1 is below 0"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {seed: 1.5}}", "f:7:29", "not a whole number"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {selection_samples: 99}}", "f:7:42",
         "99 is below 100"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {monte_carlo_trials_max: 9999}}", "f:7:47",
         "9999 is below 10000"},
        {"[nalsa]", "[nalsa]\nparameters: {window: {plane_scale_bound: 0.2}}", "f:7:42",
         "0.2 is above 0.1"},
    };
    test::expect_named(least, cases);
}

TEST(AttemptScreening, HasItsDefaults) {
    const auto screen = *parameters_of(read_attempt(least, "f"), "screen");
    EXPECT_EQ(screen.at("family_false_alarm_rate"), 0.001);
    EXPECT_EQ(screen.at("power"), 0.8);
    EXPECT_EQ(screen.at("burst_epochs_max"), 20);
    EXPECT_EQ(screen.at("noise"), "fitted");
    EXPECT_EQ(screen.at("velocity_delay_max_s"), 1.0);
    EXPECT_EQ(screen.at("velocity_share_max"), 0.05);
    EXPECT_EQ(screen.at("satellites_min"), 5);
    EXPECT_EQ(screen.at("ratio_min"), 1.5);
    EXPECT_EQ(screen.at("correction_age_max_s"), 30);
    EXPECT_EQ(screen.at("session_gap_s"), 60);
}

TEST(AttemptScreening, ItsLimitsAreThoseOfTheCraftsClass) {
    const struct {
        std::string name;
        double acceleration_m_s2, jerk_m_s3, vertical_rate_m_s;
    } classes[] = {{"land-yacht", 20, 200, 5}, {"ice-yacht", 20, 200, 5},
                   {"sail-boat", 15, 150, 5},  {"board", 20, 300, 8},
                   {"car", 25, 300, 10},       {"skydiver", 40, 400, 200},
                   {"other", 50, 500, 300}};
    for (const auto& each : classes) {
        const ScreenParameters screen =
            read_attempt(replaced(least, "class: board", "class: " + each.name), "f")
                .parameters.screen;
        EXPECT_EQ(screen.acceleration_max_m_s2, each.acceleration_m_s2) << each.name;
        EXPECT_EQ(screen.jerk_max_m_s3, each.jerk_m_s3) << each.name;
        EXPECT_EQ(screen.vertical_rate_max_m_s, each.vertical_rate_m_s) << each.name;
    }
}

TEST(AttemptScreening, EachFieldKeepsToItsRange) {
    const struct {
        std::string field, good, bad, said;
    } cases[] = {
        {"family_false_alarm_rate", "1.0e-9", "1.0e-10", "is below 1e-09"},
        {"family_false_alarm_rate", "0.1", "0.2", "0.2 is above 0.1"},
        {"power", "0.5", "0.4", "0.4 is below 0.5"},
        {"power", "0.999", "1", "1 is above 0.999"},
        {"burst_epochs_max", "2", "1", "1 is below 2"},
        {"burst_epochs_max", "100", "101", "101 is above 100"},
        {"noise", "stated", "guessed", "\"guessed\" is not one of fitted, stated"},
        {"acceleration_max_m_s2", "30", "0", "is below 1 m s-2"},
        {"jerk_max_m_s3", "30", "-1", "is below 1 m s-3"},
        {"vertical_rate_max_m_s", "2", "0", "is below 0.1 m / s"},
        {"velocity_delay_max_s", "0", "-0.1", "-0.1 is below 0 s"},
        {"velocity_delay_max_s", "5", "5.1", "5.1 is above 5 s"},
        {"velocity_share_max", "0.001", "0", "0 is below 0.001"},
        {"velocity_share_max", "1", "1.01", "1.01 is above 1"},
        {"session_gap_s", "1", "0.5", "0.5 is below 1 s"},
    };
    for (const auto& c : cases) {
        const auto with = [&c](const std::string& text, const std::string& value) {
            return replaced(text, "[nalsa]",
                            "[nalsa]\nparameters: {screen: {" + c.field + ": " + value + "}}");
        };
        const Attempt attempt = read_attempt(with(least, c.good), "f");
        EXPECT_EQ(attempt.overrides, std::vector<std::string>{"screen." + c.field});
        const auto bad = failure_of([&] { read_attempt(with(least, c.bad), "f"); });
        EXPECT_TRUE(bad.contains(c.said)) << c.field << "\n" << bad.problem;
        EXPECT_EQ(bad.where, "f:7:" + std::to_string(25 + c.field.size()));
    }
}

TEST(Attempt, AStageGetsWhatTheFieldsDeclareForItAndNoMore) {
    const std::string text = least +
                             "origin: {latitude_deg: 35.0, longitude_deg: 137.0, height_m: 40}\n"
                             "wheel: {file: wheel.csv, source: hub, scale: 1.01, "
                             "expanded_uncertainty_scale: 0.002}\n"
                             "parameters: {screen: {gap_max_s: 3}, smooth: {robust_scale: 3}}\n";
    const Attempt attempt = read_attempt(text, "f");
    const Attempt enu = part_read_by(attempt, "enu");
    EXPECT_EQ(enu.origin->height_m, 40.0);
    EXPECT_EQ(enu.receivers.at(0).id, attempt.receivers.at(0).id);
    EXPECT_TRUE(enu.receivers.at(0).recordings.empty());
    EXPECT_TRUE(!enu.wheel && enu.id.empty() && enu.profiles.empty());
    const Attempt screen = part_read_by(attempt, "screen");
    EXPECT_FALSE(screen.origin);
    EXPECT_EQ(screen.wheel->scale, 1.01);
    EXPECT_EQ(screen.wheel->source, "");
    EXPECT_EQ(screen.parameters.screen.gap_max_s, 3.0);
    EXPECT_EQ(screen.parameters.smooth.robust_scale, 2.0);
    const Attempt window = part_read_by(attempt, "window");
    EXPECT_EQ(window.parameters.screen.gap_max_s, 3.0);
    EXPECT_EQ(window.profiles, attempt.profiles);
    const nlohmann::ordered_json smooth = *settings_of(attempt, "smooth");
    EXPECT_EQ(smooth.at("parameters").at("smooth").at("robust_scale"), 3);
    EXPECT_EQ(smooth.size(), 2U) << smooth;  // and the receiver's id
}

// Stated, the figure counts before the rule's own; by default after it.
TEST(Attempt, AFigureThatCountsBeforeTheRulesIsAnotherOneWhereItIsStated) {
    const Attempt unstated = read_attempt(least, "f");
    const Attempt stated =
        read_attempt(least + "parameters: {window: {fault_probability: 0.002, seed: 1}}\n", "f");
    EXPECT_EQ(unstated.parameters.window.fault_probability, 0.002);
    EXPECT_FALSE(settings_of(stated, "window") == settings_of(unstated, "window"));
    EXPECT_EQ(settings_of(stated, "window").at("stated"),
              nlohmann::ordered_json({"window.fault_probability"}));
    EXPECT_TRUE(settings_of(stated, "smooth") == settings_of(unstated, "smooth"));
    EXPECT_EQ(part_read_by(stated, "window").overrides,
              std::vector<std::string>{"window.fault_probability"});
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
