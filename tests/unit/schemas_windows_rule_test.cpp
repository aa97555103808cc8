#include <gtest/gtest.h>

#include <string>

#include "schemas/windows/windows.h"
#include "store_test_support.h"

// The rule that windows follow, and several that make a figure.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

CertifiableWindow window(double speed_m_s, double standard_uncertainty_m_s) {
    CertifiableWindow window;
    window.span.duration.nanoseconds = 10'000'000'000;
    window.speed_m_s = speed_m_s;
    window.standard_uncertainty_m_s = standard_uncertainty_m_s;
    window.length_m = 10.0 * speed_m_s;
    return window;
}

FurtherWindow further(double speed_m_s, double standard_uncertainty_m_s) {
    FurtherWindow window;
    window.span = {.first_epoch = 201,
                   .last_epoch = 301,
                   .start = {20'000'000'000},
                   .duration = {10'000'000'000},
                   .start_gps = std::nullopt};
    window.arc = 2;
    window.speed_m_s = speed_m_s;
    window.standard_uncertainty_m_s = standard_uncertainty_m_s;
    return window;
}

Windows windows(const ProfileWindows& profile) {
    Windows windows;
    windows.header = {.schema_name = "windows",
                      .schema_version = "1.0",
                      .stage = "window",
                      .program_version = "1.0.0",
                      .source_revision = "unknown",
                      .programs = {},
                      .inputs = {}};
    windows.receiver = "primary";
    windows.profiles = {profile};
    return windows;
}

TEST(WindowRuleText, EveryMemberRoundTrips) {
    for (const WindowRule& rule :
         {WindowRule{.duration_s = 3.0, .definition = SpeedDefinition::displacement},
          WindowRule{.duration_s = 2.0,
          .definition = SpeedDefinition::mean_n,
          .source = SpeedSource::velocity,
          .count = 5},
          WindowRule{.duration_s = 3.0,
          .definition = SpeedDefinition::displacement,
          .dimension = Dimension::vertical,
          .exact = true},
          WindowRule{.kind = WindowKind::distance,
          .distance_m = 500.0,
          .definition = SpeedDefinition::path_length,
          .ends = WindowEnds::any,
          .opposite_runs = true},
          WindowRule{.kind = WindowKind::course,
          .distance_m = 1852.0,
          .definition = SpeedDefinition::elapsed_time},
          WindowRule{.duration_s = 3.0,
          .definition = SpeedDefinition::displacement,
          .opposite_runs = true,
          .opposite_runs_within_s = 3600.5,
          .runs = "{\"turn_deg\":120}",
          .within = "{\"from\":{\"event\":\"exit\"}}"},
          WindowRule{.kind = WindowKind::alpha,
          .distance_m = 250.0,
          .definition = SpeedDefinition::path_length,
          .alpha = AlphaChoice::any,
          .proximity_m = 50.0,
          .turn_deg = 90.0}}) {
        const std::string text =
            write_windows(windows({.profile = "p", .rule = rule, .best = {}, .indicated = {}}));
        EXPECT_EQ(read_windows(text, "f").profiles.at(0).rule, rule) << text;
        EXPECT_EQ(text.find("duration_s:") != std::string::npos, rule.kind == WindowKind::time);
        EXPECT_EQ(text.find("distance_m:") != std::string::npos, rule.kind != WindowKind::time);
    }
}

TEST(WindowRuleText, FurtherWindowsAndWhatIsMissingRoundTrip) {
    ProfileWindows before{
        .profile = "p",
        .rule = {.duration_s = 10.0, .definition = SpeedDefinition::mean_n, .count = 2},
        .candidates = 7,
        .missing = "two runs, but in one direction",
        .best = window(20.0, 0.25),
        .further = {further(19.5, 0.5)},
        .indicated =
            IndicatedWindow{.span = {}, .speed_m_s = 21.0, .mean_m_s = 20.25, .refusals = {}}};
    before.further[0].bias_limit_m_s = 0.75;
    const ProfileWindows back = read_windows(write_windows(windows(before)), "f").profiles.at(0);
    EXPECT_EQ(back.missing, before.missing);
    EXPECT_EQ(back.best->length_m, 200.0);
    ASSERT_EQ(back.further.size(), 1U);
    EXPECT_EQ(back.further[0].span.first_epoch, 201);
    EXPECT_EQ(back.further[0].span.start.nanoseconds, 20'000'000'000);
    EXPECT_EQ(back.further[0].arc, 2);
    EXPECT_EQ(back.further[0].speed_m_s, 19.5);
    EXPECT_EQ(back.further[0].standard_uncertainty_m_s, 0.5);
    EXPECT_EQ(back.further[0].bias_limit_m_s, 0.75);
    EXPECT_EQ(back.indicated->mean_m_s, 20.25);
}

TEST(WindowRuleText, KeepsToTheWordsOfTheFieldTable) {
    const auto with = [](const WindowRule& rule) {
        return failure_of([&] {
            write_windows(windows({.profile = "p", .rule = rule, .best = {}, .indicated = {}}));
        });
    };
    EXPECT_TRUE(with({.definition = SpeedDefinition::mean_n, .count = 0}).contains("0 is below 1"));
}

TEST(WindowRuleText, TheBiasOfAFurtherWindowIsNoNegativeOne) {
    ProfileWindows profile{
        .profile = "p",
        .rule = {.duration_s = 10.0, .definition = SpeedDefinition::mean_n, .count = 2},
        .best = {},
        .further = {further(19.5, 0.5)},
        .indicated = {}};
    profile.further[0].bias_limit_m_s = -0.25;
    EXPECT_TRUE(failure_of([&] { write_windows(windows(profile)); }).contains("below 0 m / s"));
}

TEST(RuleFigure, OfOneWindowIsItsSpeed) {
    ProfileWindows profile{.profile = "p",
                           .rule = {.duration_s = 10.0, .definition = SpeedDefinition::mean_n},
                           .best = window(20.0, 0.25),
                           .indicated = {}};
    profile.best->effective_degrees_of_freedom = 12.5;
    profile.best->bias_limit_m_s = 0.125;
    const RuleFigure figure = figure_of(profile).value();
    EXPECT_EQ(figure.speed_m_s, 20.0);
    EXPECT_EQ(figure.standard_uncertainty_m_s, 0.25);
    EXPECT_EQ(figure.effective_degrees_of_freedom, 12.5);
    EXPECT_EQ(figure.bias_limit_m_s, 0.125);
    profile.best.reset();
    EXPECT_FALSE(figure_of(profile));
}

/// One error common to all moves their mean as it moves each: uncertainties add as speeds do, and
/// so do limits of a bias.
TEST(RuleFigure, OfSeveralIsTheMeanAndItsUncertaintyThatOfACommonError) {
    ProfileWindows profile{
        .profile = "p",
        .rule = {.duration_s = 10.0, .definition = SpeedDefinition::mean_n, .count = 3},
        .best = window(20.0, 0.25),
        .further = {further(19.0, 0.5), further(18.0, 0.75)},
        .indicated = {}};
    profile.best->bias_limit_m_s = 0.125;
    profile.further[1].bias_limit_m_s = 0.25;
    EXPECT_DOUBLE_EQ(figure_of(profile)->speed_m_s, 19.0);
    EXPECT_DOUBLE_EQ(figure_of(profile)->standard_uncertainty_m_s, 0.5);
    EXPECT_DOUBLE_EQ(figure_of(profile)->bias_limit_m_s, 0.125);
    profile.further.pop_back();
    EXPECT_FALSE(figure_of(profile));  // two of three
}

TEST(RuleFigure, OfTwoRunsNeedsBoth) {
    ProfileWindows profile{.profile = "p",
                           .rule = {.duration_s = 10.0,
                                    .definition = SpeedDefinition::path_length,
                                    .opposite_runs = true},
                           .best = window(20.0, 0.25),
                           .indicated = {}};
    EXPECT_FALSE(figure_of(profile));
    profile.further = {further(18.0, 0.75)};
    EXPECT_DOUBLE_EQ(figure_of(profile)->speed_m_s, 19.0);
    EXPECT_DOUBLE_EQ(figure_of(profile)->standard_uncertainty_m_s, 0.5);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
