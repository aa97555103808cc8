#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "reports/comparison/value_comparison.h"
#include "store/document_schema.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

/// What the documents of these tests hold, as a field table declares it.
const DocumentSchema& declared() {
    static const DocumentSchema schema = DocumentSchema::parse(
        "schema: x\nversion: \"1.0\"\nfields:\n"
        "  best: {type: map, description: window}\n"
        "  best.speed_m_s: {type: real, decimals: 9, description: v}\n"
        "  speed_km_h: {type: real, decimals: 6, description: v}\n"
        "  value: {type: real, decimals: 6, description: x}\n"
        "  coarse: {type: real, decimals: 4, description: x}\n"
        "  sigma_m: {type: real, decimals: 6, description: s}\n"
        "  whole: {type: integer, description: n}\n"
        "  words: {type: text, description: w}\n"
        "  runs: {type: list, description: runs}\n"
        "  runs[]: {type: map, description: run}\n"
        "  runs[].probability: {type: real, decimals: 4, description: p}\n"
        "  runs[].duration_s: {type: real, decimals: 3, description: d}\n"
        "  runs[].count: {type: integer, description: n}\n"
        "  runs[].words: {type: text, description: w}\n",
        "x.yaml");
    return schema;
}

ValueDifference only_difference(const Json& a, const Json& b) {
    const auto found = value_differences(a, b, {.declared = &declared()});
    EXPECT_EQ(found.size(), 1U) << a << b;
    return found.empty() ? ValueDifference{} : found.front();
}

TEST(ValueComparison, EqualDocumentsHaveNoDifference) {
    const Json document{{"a", 1}, {"b", {1.5, "x", true, nullptr}}, {"c", {{"d", 2.0}}}};
    EXPECT_TRUE(value_differences(document, document).empty());
    // The order of a map's members is none of its contents; 2 and 2.0 are the same number.
    EXPECT_TRUE(value_differences({{"a", 1}, {"b", 2}}, {{"b", 2.0}, {"a", 1}}).empty());
}

TEST(ValueComparison, EveryDifferenceIsNamedByItsPath) {
    const Json a{{"list", {1, 2, 3}}, {"map", {{"gone", true}, {"kept", "x"}}}};
    const Json b{{"list", {1, 5}}, {"map", {{"kept", "y"}, {"new", 0.5}}}};
    std::vector<std::string> found;
    for (const ValueDifference& each : value_differences(a, b)) {
        found.push_back(each.path + " " + each.a + " " + each.b);
        EXPECT_FALSE(each.tolerated) << each.path;
    }
    EXPECT_EQ(found,
              (std::vector<std::string>{"list.1 2 5", "list.2 3 absent", "map.gone true absent",
                                        "map.kept \"x\" \"y\"", "map.new absent 0.5"}));
}

TEST(ValueComparison, ASpeedIsHeldAgainstTheUncertaintyAboveIt) {
    const Json a{{"best", {{"standard_uncertainty_m_s", 0.02}, {"speed_m_s", 62.130472}}}};
    Json b = a;
    b["best"]["speed_m_s"] = 62.130472 + 0.00001;  // half a thousandth of 0.02
    ValueDifference found = only_difference(a, b);
    EXPECT_NEAR(found.ratio.value(), 0.0005, 1e-9);
    EXPECT_TRUE(found.tolerated);
    b["best"]["speed_m_s"] = 62.130472 + 0.00003;
    found = only_difference(a, b);
    EXPECT_NEAR(found.ratio.value(), 0.0015, 1e-9);
    EXPECT_NEAR(found.difference.value(), 0.00003, 1e-12);
    EXPECT_FALSE(found.tolerated);
}

TEST(ValueComparison, UnitsOfASpeedAndUncertaintiesBesideAValue) {
    // Expanded over 2, in km/h: a thousandth of 0.18 km/h is 0.00018 km/h.
    const Json verdict{{"expanded_uncertainty_m_s", 0.1}, {"speed_km_h", 223.6697}};
    EXPECT_TRUE(
        only_difference(verdict, {{"expanded_uncertainty_m_s", 0.1}, {"speed_km_h", 223.66985}})
            .tolerated);
    EXPECT_FALSE(
        only_difference(verdict, {{"expanded_uncertainty_m_s", 0.1}, {"speed_km_h", 223.6700}})
            .tolerated);
    const Json figure{{"value", 0.372479}, {"expanded_uncertainty", 0.058}};
    EXPECT_TRUE(
        only_difference(figure, {{"value", 0.372500}, {"expanded_uncertainty", 0.058}}).tolerated);
    EXPECT_FALSE(
        only_difference(figure, {{"value", 0.372600}, {"expanded_uncertainty", 0.058}}).tolerated);
}

TEST(ValueComparison, WithoutUncertaintyTheLastDigitDeclaredDecides) {
    EXPECT_TRUE(only_difference({{"coarse", 0.1234}}, {{"coarse", 0.1235}}).tolerated);
    EXPECT_FALSE(only_difference({{"coarse", 0.1234}}, {{"coarse", 0.1236}}).tolerated);
    EXPECT_TRUE(only_difference({{"value", 1e-06}}, {{"value", 2e-06}}).tolerated);
    EXPECT_FALSE(only_difference({{"value", 1e-06}}, {{"value", 3e-06}}).tolerated);
    EXPECT_FALSE(only_difference({{"whole", 7}}, {{"whole", 8}}).tolerated);
    // Reals that are no difference apart, and whole numbers that are.
    EXPECT_FALSE(
        only_difference({{"whole", 9007199254740992}}, {{"whole", 9007199254740993}}).tolerated);
    EXPECT_FALSE(only_difference({{"undeclared", 0.1}}, {{"undeclared", 0.2}}).tolerated);
    // An uncertainty to a thousandth of itself.
    EXPECT_TRUE(only_difference({{"sigma_m", 0.018281}}, {{"sigma_m", 0.018295}}).tolerated);
    EXPECT_FALSE(only_difference({{"sigma_m", 0.018281}}, {{"sigma_m", 0.018381}}).tolerated);
    // Without a declaration nothing is tolerated.
    EXPECT_FALSE(value_differences({{"coarse", 0.1234}}, {{"coarse", 0.1235}})[0].tolerated);
}

TEST(ValueComparison, ADeclarationDecidesWhatAValueIsWrittenTo) {
    const auto tolerated = [&](const Json& from, const Json& to, bool deciding) {
        const Json a{{"runs", {from}}};
        const Json b{{"runs", {to}}};
        const auto found = value_differences(a, b, {.declared = &declared(), .deciding = deciding});
        EXPECT_EQ(found.size(), 1U) << a << b;
        return found.size() == 1 && found.front().tolerated;
    };
    // Whole where they are written, and real where they are declared.
    EXPECT_FALSE(tolerated({{"probability", 1}}, {{"probability", 0}}, false));
    EXPECT_FALSE(tolerated({{"probability", 1.0}}, {{"probability", 0.0}}, false));
    EXPECT_FALSE(tolerated({{"duration_s", 3.0}}, {{"duration_s", 2.0}}, false));
    EXPECT_TRUE(tolerated({{"duration_s", 3.0}}, {{"duration_s", 3.001}}, false));
    EXPECT_FALSE(tolerated({{"duration_s", 3.0}}, {{"duration_s", 3.001}}, true));
    EXPECT_TRUE(tolerated({{"duration_s", 3.0}}, {{"duration_s", 3.000000001}}, true));
    EXPECT_FALSE(tolerated({{"count", 3}}, {{"count", 4}}, false));
    EXPECT_FALSE(tolerated({{"words", "62.1 km/h"}}, {{"words", "62.2 km/h"}}, false));
    // A millionth of the uncertainty that was computed here, not of the one in the other document.
    const Json speed{{"speed_m_s", 62.130472}, {"standard_uncertainty_m_s", 0.02}};
    EXPECT_TRUE(
        tolerated(speed, {{"speed_m_s", 62.13047201}, {"standard_uncertainty_m_s", 0.02}}, true));
    EXPECT_FALSE(
        tolerated(speed, {{"speed_m_s", 62.130473}, {"standard_uncertainty_m_s", 0.02}}, true));
}

TEST(ValueComparison, NoTextIsTolerated) {
    EXPECT_FALSE(only_difference({{"words", "speed 62.131 m/s"}}, {{"words", "speed 62.132 m/s"}})
                     .tolerated);
}

std::vector<std::string> paths_of(const Json& a, const Json& b) {
    std::vector<std::string> paths;
    for (const ValueDifference& each : value_differences(a, b)) {
        paths.push_back(each.path);
        EXPECT_FALSE(each.tolerated) << each.path;
    }
    return paths;
}

TEST(ValueComparison, EntriesOfListsAreMatchedByWhatNamesThem) {
    const Json nalsa{{"profile", "nalsa"}, {"speed", 1.5}}, fisly{{"profile", "fisly"}};
    Json faster = nalsa;
    faster["speed"] = 1.6;
    const Json alone{{"profiles", {nalsa}}}, behind{{"profiles", {fisly, faster}}};
    EXPECT_EQ(paths_of(alone, behind),
              (std::vector<std::string>{"profiles.0.speed", "profiles.0"}));
    const auto places = tree_differences(behind, alone);
    ASSERT_EQ(places.size(), 2U);
    EXPECT_EQ(places[0].path, "profiles.0");
    EXPECT_EQ(places[0].declared, "profiles[]");
    EXPECT_EQ(places[0].b, nullptr);
    EXPECT_EQ(places[1].path, "profiles.1.speed");
    EXPECT_EQ(places[1].declared, "profiles[].speed");
    EXPECT_EQ(places[1].keys, std::vector<std::string>{"nalsa"});
    EXPECT_EQ(*places[1].maps.back(), faster);
    EXPECT_EQ(*places[1].map_b, nalsa);
}

TEST(ValueComparison, AnotherOrderIsADifference) {
    const Json one{{"id", "one"}}, two{{"id", "two"}}, none{{"id", 3}};
    EXPECT_EQ(paths_of({{"list", {one, two}}}, {{"list", {two, one}}}),
              (std::vector<std::string>{"list.1", "list.0"}));
    EXPECT_EQ(paths_of({{"list", {one, one}}}, {{"list", {one}}}),
              std::vector<std::string>{"list.1"});
    EXPECT_EQ(paths_of({{"list", {none, one}}}, {{"list", {one}}}),
              std::vector<std::string>{"list.0"});
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
