#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/diff/run_difference.h"
#include "reports/comparison/table_comparison.h"
#include "reports/document/document_text.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A table of an epoch, a time, a position with its uncertainty, a count and a word.
std::string table(const std::string& rows, const std::string& first_epoch = {},
                  const std::string& more_meta = {}) {
    return "# %ECSV 1.0\n# ---\n# datatype:\n"
           "#   - {name: epoch, datatype: int64}\n"
           "#   - {name: time, unit: s, datatype: float64, format: \"%.9f\"}\n"
           "#   - {name: east, unit: m, datatype: float64, format: \"%.6f\"}\n"
           "#   - {name: sigma_east, unit: m, datatype: float64, format: \"%.6f\"}\n"
           "#   - {name: satellites, datatype: int64}\n"
           "#   - {name: reason, datatype: string}\n"
           "# delimiter: ','\n# meta:\n#   schema: {name: t, version: '1.0'}\n" +
           (first_epoch.empty() ? "" : "#   first_epoch_gps: '" + first_epoch + "'\n") + more_meta +
           "epoch,time,east,sigma_east,satellites,reason\n" + rows;
}

const std::string three =
    "1,0.000000000,10.000000,0.010000,9,none\n"
    "2,0.100000000,11.000000,0.010000,9,none\n"
    "3,0.200000000,12.000000,0.010000,9,none\n";

TableComparison compare(const std::string& a, const std::string& b) {
    return compare_tables(a, b, "a.ecsv", "b.ecsv");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(TableComparison, ATableEqualsItself) {
    const TableComparison found = compare(table(three), table(three));
    EXPECT_TRUE(found.equal());
    EXPECT_TRUE(found.tolerated());
    EXPECT_EQ(found.joined, 3);
}

TEST(TableComparison, TheLargestChangeIsThatAgainstItsOwnUncertainty) {
    std::string other = replaced(three, "10.000000,0.010000", "10.005000,0.010000");
    other = replaced(other, "12.000000", "11.992000");
    // The last has the larger difference, and the larger uncertainty in the first table.
    const std::string rows = replaced(three, "12.000000,0.010000", "12.000000,0.080000");
    const TableComparison found = compare(table(rows), table(other));
    ASSERT_EQ(found.columns.size(), 2U);
    const ColumnDifference& east = found.columns.front();
    EXPECT_EQ(east.column, "east");
    EXPECT_EQ(east.cells, 2);
    EXPECT_EQ(east.largest.row.epoch_a, 1);
    EXPECT_EQ(east.largest.row.line_a, 14);
    EXPECT_EQ(east.largest.a, "10.000000");
    EXPECT_EQ(east.largest.b, "10.005000");
    EXPECT_NEAR(east.largest.difference.value(), 0.005, 1e-12);
    EXPECT_NEAR(east.largest.ratio.value(), 0.5, 1e-9);
    EXPECT_EQ(found.columns.back().column, "sigma_east");
    ASSERT_TRUE(found.first_not_tolerated.has_value());
    EXPECT_EQ(found.first_not_tolerated->column, "east");
    EXPECT_EQ(found.first_not_tolerated->row.epoch_a, 1);
    EXPECT_FALSE(found.tolerated());
}

TEST(TableComparison, AThousandthOfTheUncertaintyIsTolerated) {
    const std::string within = replaced(three, "11.000000", "11.000010");
    const std::string beyond = replaced(three, "11.000000", "11.000011");
    EXPECT_TRUE(compare(table(three), table(within)).tolerated());
    EXPECT_FALSE(compare(table(three), table(within)).equal());
    EXPECT_FALSE(compare(table(three), table(beyond)).tolerated());
    // Counts and words never.
    EXPECT_FALSE(compare(table(three), table(replaced(three, ",9,none", ",8,none"))).tolerated());
    EXPECT_FALSE(compare(table(three), table(replaced(three, "none", "burst"))).tolerated());
    EXPECT_FALSE(compare(table(three), table(replaced(three, "10.000000", ""))).tolerated());
}

TEST(TableComparison, RowsAreJoinedByTime) {
    // The second row is missing, and the third is another's second.
    const std::string fewer =
        "1,0.000000000,10.000000,0.010000,9,none\n"
        "2,0.200000000,12.500000,0.010000,9,none\n";
    const TableComparison found = compare(table(three), table(fewer));
    EXPECT_EQ(found.joined, 2);
    EXPECT_EQ(found.rows_a, 3);
    EXPECT_EQ(found.rows_b, 2);
    EXPECT_EQ(found.only_a_line.value(), 15);
    EXPECT_FALSE(found.only_b_line.has_value());
    ASSERT_EQ(found.columns.size(), 2U);  // the epoch's number, and its position
    EXPECT_EQ(found.columns.back().largest.row.epoch_a, 3);
    EXPECT_EQ(found.columns.back().largest.row.epoch_b, 2);
    EXPECT_FALSE(found.tolerated());
    EXPECT_FALSE(found.equal());
}

TEST(TableComparison, TimesAreComparedOnTheGpsScaleWhereBothHaveIt) {
    // The same instants, counted from another first epoch.
    const std::string later =
        "1,0.000000000,11.000000,0.010000,9,none\n"
        "2,0.100000000,12.000000,0.010000,9,none\n";
    const TableComparison found =
        compare(table(three, "2026-01-01T00:00:00.000"), table(later, "2026-01-01T00:00:00.100"));
    EXPECT_EQ(found.joined, 2);
    for (const ColumnDifference& column : found.columns)
        EXPECT_NE(column.column, "east");
    ASSERT_EQ(found.header.size(), 1U);
    EXPECT_EQ(found.header.front().path, "first_epoch_gps");
}

TEST(TableComparison, EqualTimesAreJoinedInTheirOrderAndNoRowTwice) {
    const auto match = [](const std::vector<int>& a, const std::vector<int>& b) {
        std::vector<std::string> found;
        for (const MatchedPlaces& places : match_by_key(a, b))
            found.push_back(fmt::format("{}-{}", places.a ? fmt::format("{}", *places.a) : "",
                                        places.b ? fmt::format("{}", *places.b) : ""));
        return found;
    };
    EXPECT_EQ(match({}, {1}), std::vector<std::string>{"-0"});
    // 3 lies before what was matched already.
    EXPECT_EQ(match({5, 5, 3, 7}, {5, 3, 5, 7, 7}),
              (std::vector<std::string>{"0-0", "1-2", "2-", "3-3", "-1", "-4"}));
}

std::string without_time(std::string table) {
    table = replaced(std::move(table), ",time,", ",north,");
    return replaced(std::move(table), "name: time", "name: north");
}

// A surveyed surface has no time: two runs with one could not be compared.
TEST(TableComparison, RowsWithoutATimeAreMatchedByTheirOrder) {
    const std::string other = replaced(three, "12.000000", "12.500000");
    const TableComparison found =
        compare(without_time(table(three)), without_time(table(other + other)));
    EXPECT_EQ(found.joined, 3);
    EXPECT_EQ(found.rows_b, 6);
    EXPECT_EQ(found.only_b_line.value(), 17);
    ASSERT_EQ(found.columns.size(), 1U);
    EXPECT_EQ(found.columns[0].largest.row.line_a, 16);
    // One that lost its times is no table as the other.
    EXPECT_EQ(compare(table(three), without_time(table(three))).columns_only_a,
              std::vector<std::string>{"time"});
}

TEST(TableComparison, WhoMadeATableIsNoneOfItsResults) {
    const std::string made =
        "#   stage: {name: s, version: '1', source_revision: abc}\n"
        "#   inputs: []\n#   parameters: {x: 1}\n";
    EXPECT_TRUE(compare(table(three, {}, made), table(three)).equal());
    EXPECT_FALSE(
        compare(table(three, {}, "#   arcs: 2\n"), table(three, {}, "#   arcs: 3\n")).equal());
    EXPECT_EQ(parts_of(table(three, {}, made), "t.ecsv").header["parameters"]["x"], 1);
}

TEST(TableComparison, WhatIsNoTableIsRefused) {
    EXPECT_THROW(compare("no table", table(three)), Failure);
    EXPECT_THROW(compare(table(three), ""), Failure);
}

using Json = nlohmann::ordered_json;

Json windows_of(double speed, double uncertainty, double start) {
    return {{"profiles",
             {{{"profile", "nalsa"},
               {"best",
                {{"start_time_s", start},
                 {"duration_s", 3.0},
                 {"speed_m_s", speed},
                 {"standard_uncertainty_m_s", uncertainty}}}}}}};
}

TEST(RunDifference, ASpeedsChangeIsInUnitsOfTheCombinedExpandedUncertainty) {
    // 2 * hypot(0.3, 0.4) = 1.
    const auto changes =
        window_changes(windows_of(60.0, 0.3, 5.0), windows_of(60.25, 0.4, 5.5), "");
    ASSERT_EQ(changes.size(), 3U);
    EXPECT_EQ(changes[0], (Change{"nalsa, best window, start", "5.000 s", "5.500 s", "+0.500 s"}));
    EXPECT_EQ(changes[1],
              (Change{"nalsa, best window, speed", "60.000000 m/s", "60.250000 m/s",
                      "+0.250000 m/s, 0.2500 of the combined expanded uncertainty (k = 2)"}));
    EXPECT_EQ(changes[2].what, "nalsa, best window, standard uncertainty");
    EXPECT_TRUE(window_changes(windows_of(60.0, 0.3, 5.0), windows_of(60.0, 0.3, 5.0), "").empty());
    const Json none{{"profiles", {{{"profile", "nalsa"}}}}};
    EXPECT_EQ(window_changes(windows_of(60.0, 0.3, 5.0), none, "").front().b, "none");
    Json odd = windows_of(60.0, 0.3, 5.0);
    odd["profiles"][0]["best"]["speed_m_s"] = Json::object();
    EXPECT_TRUE(window_changes(windows_of(60.0, 0.3, 5.0), odd, "").empty());
}

TEST(RunDifference, OutcomesAndRequirements) {
    const auto verdict = [](const char* outcome, const char* status) {
        return Json{{"profiles",
                     {{{"profile", "nalsa"},
                       {"outcome", outcome},
                       {"requirements", {{{"clause", "margin"}, {"status", status}}}}}}}};
    };
    EXPECT_TRUE(verdict_changes(verdict("beaten", "met"), verdict("beaten", "met")).empty());
    const auto changes =
        verdict_changes(verdict("beaten", "met"), verdict("not_proven", "not_met"));
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[0], (Change{"nalsa, outcome", "beaten", "not_proven"}));
    EXPECT_EQ(changes[1], (Change{"nalsa, margin", "met", "not_met"}));
    // Of a rule that one run alone claims the outcome, and no more.
    EXPECT_EQ(verdict_changes({{"profiles", Json::array()}}, verdict("beaten", "met")),
              (std::vector<Change>{{"nalsa, outcome", "none", "beaten"}}));
    // What nobody writes is no reason to fail.
    EXPECT_EQ(verdict_changes({{"profiles", {{{"profile", 1}, {"outcome", {{"x", 1}}}}}}},
                              verdict("beaten", "met"))
                  .size(),
              1U);
}

TEST(RunDifference, HostileNamesDoNotSteerTheTerminalAndListsAreCut) {
    RunDifference difference;
    EXPECT_TRUE(difference.equal());
    difference.causes.attempt.push_back({"place", "\x1b[31mred", "\xE2\x80\xAEgnp"});
    EpochDifference& epochs = difference.epochs.emplace_back();
    epochs.receiver = "primary";
    epochs.rows_a = epochs.rows_b = epochs.joined = 25;
    for (int i = 0; i < 25; ++i)
        epochs.changes.push_back({.row = {.epoch_a = i, .epoch_b = i}, .a = "used", .b = "out"});
    EXPECT_FALSE(difference.equal());
    const std::string text = document_text(difference_document(difference, "a", "b", false), 80);
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
    EXPECT_EQ(text.find("\xE2\x80\xAE"), std::string::npos);
    EXPECT_NE(text.find("used -> out       25 epochs"), std::string::npos) << text;
    EXPECT_NE(text.find("and 5 more (--all lists them)"), std::string::npos) << text;
    EXPECT_NE(document_text(difference_document(difference, "a", "b", true), 80)
                  .find("\n   24  0.000 s  used  out\n"),
              std::string::npos);
    EXPECT_NE(text.find("\n   19  0.000 s  used  out\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("\n   20  "), std::string::npos) << text;
    EXPECT_EQ(difference_json(difference)["epochs"][0]["changes"].size(), 25U);
    EXPECT_EQ(difference_json(difference)["equal"], false);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
