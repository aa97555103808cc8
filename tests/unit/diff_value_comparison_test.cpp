#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "reports/diff/value_comparison.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

ValueDifference only_difference(const Json& a, const Json& b) {
    const auto found = value_differences(a, b);
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

TEST(ValueComparison, WithoutUncertaintyTheLastDigitDecides) {
    EXPECT_TRUE(only_difference({{"x", 0.1234}}, {{"x", 0.1235}}).tolerated);
    EXPECT_FALSE(only_difference({{"x", 0.1234}}, {{"x", 0.1236}}).tolerated);
    EXPECT_TRUE(only_difference({{"x", 1e-06}}, {{"x", 2e-06}}).tolerated);
    EXPECT_FALSE(only_difference({{"x", 1e-06}}, {{"x", 3e-06}}).tolerated);
    EXPECT_FALSE(only_difference({{"x", 7}}, {{"x", 8}}).tolerated);
    // An uncertainty to a thousandth of itself.
    EXPECT_TRUE(only_difference({{"sigma_m", 0.018281}}, {{"sigma_m", 0.018295}}).tolerated);
    EXPECT_FALSE(only_difference({{"sigma_m", 0.018281}}, {{"sigma_m", 0.018381}}).tolerated);
}

TEST(ValueComparison, TextsByTheirNumbers) {
    EXPECT_TRUE(
        only_difference({{"t", "speed 62.131 m/s"}}, {{"t", "speed 62.132 m/s"}}).tolerated);
    EXPECT_FALSE(
        only_difference({{"t", "speed 62.131 m/s"}}, {{"t", "speed 62.133 m/s"}}).tolerated);
    EXPECT_FALSE(only_difference({{"t", "epoch 597"}}, {{"t", "epoch 598"}}).tolerated);
    EXPECT_FALSE(only_difference({{"outcome", "beaten"}}, {{"outcome", "not_beaten"}}).tolerated);
    EXPECT_FALSE(only_difference({{"t", "0.1 m"}}, {{"t", "0.1 m, and more"}}).tolerated);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
