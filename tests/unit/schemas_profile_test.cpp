#include <gtest/gtest.h>

#include <string>

#include "schemas/profile/profile.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

const std::string sample = R"(schema: profile/1.0
id: my-rule
body: Some Body
title: top speed
window: {duration_s: 10, definition: mean_n_plus_1}
accuracy: {limit: 0.5, unit: kn, coverage_factor: 3}
margin: {kind: absolute, value: 1, unit: mph}
rounding: {mode: nearest, unit: kn, decimals: 2}
clauses:
  - {id: c1, text: t, source: s, certainty: quoted, decided_by: window_complete}
  - {id: c2, text: t, source: s, certainty: quoted, decided_by: accuracy}
)";

TEST(Profile, EveryMemberIsRead) {
    const Profile profile = read_profile(sample, "p.yaml");
    EXPECT_EQ(profile.body, "Some Body");
    EXPECT_EQ(profile.title, "top speed");
    EXPECT_EQ(profile.definition, SpeedDefinition::mean_n_plus_1);
    EXPECT_DOUBLE_EQ(profile.accuracy_limit_m_s.value(), 0.5 * 1852.0 / 3600.0);
    EXPECT_EQ(profile.coverage_factor, 3.0);
    EXPECT_EQ(profile.clauses.at(1).id, "c2");
    EXPECT_EQ(profile.clauses.at(1).text, "t");
    EXPECT_EQ(profile.clauses.at(1).source, "s");
    EXPECT_EQ(profile.clauses.at(1).certainty, Certainty::quoted);
    EXPECT_EQ(profile.clauses.at(1).decided_by, Computation::accuracy);
}

TEST(Profile, BadInputIsNamedWithItsPlace) {
    const struct {
        std::string from, to, where, said;
    } cases[] = {
        {"decided_by: accuracy", "decided_by: dice", "p:11:65",
         "\"dice\" is not one of window_com"},
        {"certainty: quoted, decided_by: acc", "certainty: sure, decided_by: acc", "p:11:45",
         "\"sure\" is not one of quoted, secondary, unconfirmed"},
        {", unit: mph", "", "p:7:16", "kind: absolute needs unit"},
        {"kind: absolute", "kind: relative", "p:7:42", "kind: relative goes without unit"},
        {"kind: absolute", "kind: half", "p:7:16",
         "\"half\" is not one of absolute, relative, elapsed_time"},
        {"unit: mph", "unit: furlong", "p:7:42", "is not one of km/h, m/s, kn, mph, s"},
        {"value: 1", "value: -1", "p:7:33", "below 0"},
        {"value: 1", "value: '1'", "p:7:33", "not a number"},
        {"duration_s: 10", "duration_s: 0", "p:5:22", "0 is below 0.1 s"},
        {"duration_s: 10, ", "", "p:5:9", "kind: time needs duration_s. Add duration_s:"},
        {"definition: mean_n_plus_1", "definition: mean", "p:5:38", "is not one of displacement"},
        {"definition:", "defintion:", "p:5:26", "Did you mean \"definition\""},
        {"window:", "windows:", "p:5:1", "Did you mean \"window\""},
        {"coverage_factor: 3", "coverage_factor: 0.5", "p:6:51", "below 1"},
        {"accuracy: {limit: 0.5, unit: kn, coverage_factor: 3}\n", "", "p:10:65",
         "states no limit of accuracy"},
        {"decimals: 2", "decimals: 2.5", "p:8:47", "not a whole number"},
        {"mode: nearest", "mode: up", "p:8:18", "\"up\" is not one of truncate, nearest"},
        {"id: c2", "id: c1", "p:11:10", "two clauses have the id \"c1\""},
        {"{id: c2, text: t, ", "{id: c2, ", "p:11:5", "\"text\" is missing"},
        {"  - {id: c1, text: t, source: s, certainty: quoted, decided_by: window_complete}\n"
         "  - {id: c2, text: t, source: s, certainty: quoted, decided_by: accuracy}\n",
         "  []\n", "p:10:3", "the rule requires nothing"},
        {"id: my-rule\n", "", "p:1:1", "\"id\" is missing"},
        {"profile/1.0", "profile/2.0", "p:1:9", "version \"2.0\" of profile is not known"},
        {"profile/1.0", "profile/1.1", "p:1:9", "version \"1.1\" of profile is not known"},
        {"schema: profile/1.0\n", "", "p:1:1", "does not say that it follows profile/1.0"},
    };
    ASSERT_NO_THROW(read_profile(sample, "p"));
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_profile(replaced(sample, c.from, c.to), "p"); });
        EXPECT_EQ(said.where, c.where) << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem << ". " << said.remedy;
    }
    for (const char* text : {"", "[]", "x", "null", "schema: [profile/1.0]\n"})
        EXPECT_FALSE(failure_of([&] { read_profile(text, "p"); }).where.empty()) << text;
}

/// The sample with an `uncertainty` of that text.
std::string with_uncertainty(const std::string& text) {
    return replaced(sample, "clauses:\n", "uncertainty: " + text + "\nclauses:\n");
}

TEST(ProfileUncertainty, HasItsDefaults) {
    for (const std::string& text :
         {sample, with_uncertainty("{}"), std::string(builtin_profile("nalsa"))}) {
        const UncertaintyRule found = read_profile(text, "p").uncertainty;
        EXPECT_EQ(found.tau_min_s, 0.5);
        EXPECT_EQ(found.tau_max_s, 10.0);
        EXPECT_EQ(found.selection_bias, SelectionTreatment::subtracted);
        EXPECT_EQ(found.error_floor_m, (std::map<std::string, double>{{"fixed", 0.02},
                                                                      {"unknown", 0.5},
                                                                      {"float", 0.2},
                                                                      {"ppp", 0.1},
                                                                      {"dgps", 0.5},
                                                                      {"sbas", 0.5},
                                                                      {"single", 0.5},
                                                                      {"dead_reckoning", 0.5}}));
    }
}

TEST(ProfileUncertainty, TheBiasOfChoosingMayBeCovered) {
    EXPECT_EQ(
        read_profile(with_uncertainty("{selection_bias: covered}"), "p").uncertainty.selection_bias,
        SelectionTreatment::covered);
}

TEST(ProfileUncertainty, IsReadAndWhatIsLeftOutHasItsDefault) {
    const UncertaintyRule found =
        read_profile(with_uncertainty("{correlation_time_max_s: 4, selection_bias: subtracted, "
                                      "error_floor_m: {fixed: 0, single: 2.5}}"),
                     "p")
            .uncertainty;
    EXPECT_EQ(found.tau_min_s, 0.5);
    EXPECT_EQ(found.tau_max_s, 4.0);
    EXPECT_EQ(found.selection_bias, SelectionTreatment::subtracted);
    EXPECT_EQ(found.error_floor_m.at("fixed"), 0.0);
    EXPECT_EQ(found.error_floor_m.at("single"), 2.5);
    EXPECT_EQ(found.error_floor_m.at("float"), 0.2);
}

TEST(ProfileUncertainty, BadInputIsNamedWithItsPlace) {
    const struct {
        std::string text, where, said;
    } cases[] = {
        {"{correlation_time_min_s: 2, correlation_time_max_s: 2}", "p:9:66",
         "is 2 s, which is not above correlation_time_min_s, 2 s. Give correlation_time_max_s "
         "above correlation_time_min_s"},
        {"{correlation_time_max_s: 0.25}", "p:9:39",
         "is 0.25 s, which is not above correlation_time_min_s, 0.5 s"},
        {"{correlation_time_min_s: 20}", "p:9:39",
         "is 10 s, which is not above correlation_time_min_s, 20 s"},
        {"{correlation_time_min_s: 0}", "p:9:39", "0 is below 0.01 s"},
        {"{correlation_time_max_s: 1001}", "p:9:39", "1001 is above 1000 s"},
        {"{selection_bias: ignored}", "p:9:31", "\"ignored\" is not one of covered, subtracted"},
        {"{error_floor_m: 0.02}", "p:9:30", "not a map"},
        {"{error_floor_m: {fixd: 0.02}}", "p:9:31", "Did you mean \"fixed\""},
        {"{error_floor_m: {fixed: -0.02}}", "p:9:38", "-0.02 is below 0 m"},
        {"covered", "p:9:14", "not a map"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_profile(with_uncertainty(c.text), "p"); });
        EXPECT_EQ(said.where, c.where) << c.text << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.text << "\n" << said.problem << said.remedy;
    }
}

TEST(MetresPerSecond, KnowsFourUnitsAndRefusesOtherUnits) {
    EXPECT_EQ(metres_per_second("m/s"), 1.0);
    EXPECT_EQ(metres_per_second("km/h"), 1.0 / 3.6);
    EXPECT_EQ(metres_per_second("kn"), 1852.0 / 3600.0);
    EXPECT_EQ(metres_per_second("mph"), 0.44704);
    for (const char* unit : {"", "kmh", "knots", "KN", "m / s"})
        EXPECT_TRUE(failure_of([&] { metres_per_second(unit); }).contains("km/h, m/s, kn or mph"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
