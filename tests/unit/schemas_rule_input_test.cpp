#include "schemas_rule_input_support.h"

// An attempt's records of profiles, and figures that replace theirs.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace rule_input_test;

TEST(RuleInput, NothingIsGivenWhereNothingStands) {
    const Attempt attempt = read("");
    EXPECT_FALSE(attempt.record || attempt.course || attempt.wind || attempt.current ||
                 attempt.secondary_method);
    EXPECT_TRUE(attempt.records.empty() && attempt.rules.empty());
    EXPECT_EQ(attempt.record_for("nalsa"), nullptr);
}

TEST(RuleInput, ARecordMayHaveItsUncertainty) {
    const Attempt attempt =
        read("record: {speed: 202.9, unit: km/h, source: s, expanded_uncertainty: 0.5}\n");
    EXPECT_EQ(attempt.record->expanded_uncertainty, 0.5);
    EXPECT_EQ(attempt.record_for("nalsa"), &*attempt.record);
    EXPECT_EQ(attempt.record_for("my-rule"), &*attempt.record);
    EXPECT_EQ(read("record: {speed: 1, unit: kn, source: s}\n").record->expanded_uncertainty, 0.0);
}

TEST(RuleInput, ARecordOfAProfileStandsBeforeTheRecordOfAll) {
    const Attempt attempt = read(R"(record: {speed: 202.9, unit: km/h, source: s}
records:
  - {profile: my-rule, speed: 50, unit: kn, source: t, expanded_uncertainty: 0.25}
)");
    EXPECT_EQ(attempt.record_for("nalsa")->speed, 202.9);
    EXPECT_EQ(attempt.record_for("my-rule")->speed, 50.0);
    EXPECT_EQ(attempt.record_for("my-rule")->unit, "kn");
    EXPECT_EQ(attempt.record_for("my-rule")->source, "t");
    EXPECT_EQ(attempt.record_for("my-rule")->expanded_uncertainty, 0.25);
    const Attempt alone = read("records:\n  - {profile: nalsa, speed: 50, unit: kn, source: t}\n");
    EXPECT_EQ(alone.record_for("my-rule"), nullptr);
    // A profile in a file may be named as profiles has it.
    EXPECT_EQ(read("records:\n  - {profile: rules/my-rule.yaml, speed: 50, unit: kn, source: t}\n")
                  .records.count("my-rule"),
              1U);
}

TEST(RuleInput, BadRecordsAreNamedWithTheirPlace) {
    expect_refused({
        {"records:\n  - {profile: fisly, speed: 50, unit: kn, source: t}\n", "f:8:15",
         "the attempt does not claim the profile \"fisly\". Add it to profiles, or correct"},
        {"records:\n  - {profile: nalsa, speed: 50, unit: kn, source: t}\n"
         "  - {profile: nalsa, speed: 51, unit: kn, source: t}\n",
         "f:9:15", "two records are given for it. Give one"},
        {"records:\n  - {profile: my-rule, speed: 50, unit: kn, source: t}\n"
         "  - {profile: rules/my-rule.yaml, speed: 51, unit: kn, source: t}\n",
         "f:9:15", "two records are given for it"},
        {"records:\n  - {profile: nalsa, speed: 50, unit: furlong, source: t}\n", "f:8:39",
         "\"furlong\" is not one of km/h, m/s, kn, mph"},
        {"record: {speed: 50, unit: knots, source: t}\n", "f:7:27",
         "\"knots\" is not one of km/h, m/s, kn, mph"},
        {"record: {speed: 50, unit: kn, source: t, expanded_uncertainty: -1}\n", "f:7:64",
         "-1 is below 0"},
        {"records:\n  - {profile: nalsa, speed: -1, unit: kn, source: t}\n", "f:8:29",
         "-1 is below 0"},
        {"records:\n  - {profile: nalsa, speed: 50, unit: kn}\n", "f:8:5", "\"source\" is missing"},
        {"records:\n  - {speed: 50, unit: kn, source: t}\n", "f:8:5", "\"profile\" is missing"},
        {"records: {profile: nalsa}\n", "f:7:10", "is a map, not list"},
    });
}

TEST(RuleInput, FiguresThatReplaceThoseOfAProfile) {
    const Attempt attempt = read(R"(rules:
  - {profile: nalsa, figure: margin.value, value: 2, reason: as agreed}
  - {profile: nalsa, figure: clauses.flat-course.limit, value: -0.5}
  - {profile: rules/my-rule.yaml, figure: margin.value, value: 3}
)");
    ASSERT_EQ(attempt.rules.size(), 3U);
    EXPECT_EQ(attempt.rules[0].profile, "nalsa");
    EXPECT_EQ(attempt.rules[0].figure, "margin.value");
    EXPECT_EQ(attempt.rules[0].value, 2.0);
    EXPECT_EQ(attempt.rules[0].reason, "as agreed");
    EXPECT_EQ(attempt.rules[0].place, "f:8:30");
    EXPECT_EQ(attempt.rules[1].value, -0.5);
    EXPECT_EQ(attempt.rules[1].reason, "");
    EXPECT_EQ(attempt.rules[2].profile, "my-rule");
    expect_refused({
        {"rules:\n  - {profile: nalsa, figure: margin.value, value: 2}\n"
         "  - {profile: nalsa, figure: margin.value, value: 3}\n",
         "f:9:30", "it is replaced twice. Replace it once"},
        {"rules:\n  - {profile: fisly, figure: margin.value, value: 2}\n", "f:8:15",
         "does not claim the profile \"fisly\""},
        {"rules:\n  - {profile: nalsa, figure: margin.value, value: two}\n", "f:8:51",
         "not a number"},
        {"rules:\n  - {profile: nalsa, value: 2}\n", "f:8:5", "\"figure\" is missing"},
        {"rules:\n  - {profile: nalsa, figure: margin.value}\n", "f:8:5", "\"value\" is missing"},
    });
}

TEST(RuleInput, OneNameClaimsAllOfGpsSpeedSailing) {
    const auto profiles = [](const std::string& list) {
        return read_attempt(replaced(with(""), "[nalsa, rules/my-rule.yaml]", list), "f").profiles;
    };
    const std::vector<std::string> seven{
        "gps-speed-sailing-2s",       "gps-speed-sailing-10s",           "gps-speed-sailing-5x10s",
        "gps-speed-sailing-500m",     "gps-speed-sailing-nautical-mile", "gps-speed-sailing-1h",
        "gps-speed-sailing-alpha-500"};
    EXPECT_EQ(profiles("[gps-speed-sailing]"), seven);
    std::vector<std::string> eight = seven;
    eight.insert(eight.begin(), "nalsa");
    EXPECT_EQ(profiles("[nalsa, gps-speed-sailing]"), eight);
    EXPECT_EQ(profiles("[gps-speed-sailing-1h]"), std::vector<std::string>{"gps-speed-sailing-1h"});
    for (const auto& [list, where] :
         {std::pair{"[gps-speed-sailing, gps-speed-sailing-1h]", "f:6:31"},
          {"[gps-speed-sailing-1h, gps-speed-sailing]", "f:6:34"},
          {"[gps-speed-sailing, gps-speed-sailing]", "f:6:31"},
          {"[gps-speed-sailing, mine/gps-speed-sailing-2s.yaml]", "f:6:31"}}) {
        const Said said = failure_of([&, &claimed = list] { profiles(claimed); });
        EXPECT_EQ(said.where, where) << list;
        EXPECT_TRUE(said.contains("the profile is claimed twice. Name each profile once")) << list;
    }
    std::vector<std::string> on_ice = seven;
    for (std::string& name : on_ice)
        name.replace(0, std::string("gps-speed").size(), "gps-ice");
    EXPECT_EQ(profiles("[gps-ice-sailing]"), on_ice);
    // A record belongs to one of the seven rules.
    const Attempt attempt = read_attempt(
        replaced(with("records:\n  - {profile: gps-speed-sailing-1h, speed: 30, unit: km/h, "
                      "source: s}\n"),
                 "[nalsa, rules/my-rule.yaml]", "[gps-speed-sailing]"),
        "f");
    EXPECT_EQ(attempt.record_for("gps-speed-sailing-1h")->speed, 30.0);
    EXPECT_EQ(attempt.record_for("gps-speed-sailing-2s"), nullptr);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
