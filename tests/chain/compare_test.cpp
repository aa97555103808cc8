#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

#include "chain_support.h"
#include "core/text.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// What the two tables say of a method.
struct TableRow {
    std::string by;
    std::vector<std::string> cells;  ///< from s, best, certified; RMS, error best, error certified

    double number(std::size_t cell) const {
        const std::optional<double> value = parse_double(cells.at(cell));
        EXPECT_TRUE(value.has_value()) << cells.at(cell);
        return value.value_or(1e9);
    }
};

/// The rows of the rule by the method's name, which takes the first 31 columns.
std::map<std::string, TableRow> table_of(const std::string& text, const std::string& profile) {
    constexpr std::size_t name_columns = 33;
    std::map<std::string, TableRow> rows;
    std::istringstream lines(text);
    std::string in_section;
    std::string line_before;
    bool errors = false;
    for (std::string line; std::getline(lines, line); line_before = line) {
        EXPECT_LE(line.size(), 80U) << line;
        if (line.starts_with("---")) in_section = line_before;
        if (line.starts_with("Speeds in ") || line.starts_with("Errors of "))
            errors = line.starts_with("Errors of ");
        if (in_section != "Rule " + profile || line.size() < 50 || line.ends_with(':')) continue;
        std::istringstream rest(line.substr(name_columns));
        TableRow& row = rows[std::string(trim(line.substr(0, name_columns)))];
        if (!errors) rest >> row.by;
        for (std::string cell; rest >> cell;)
            row.cells.push_back(cell);
    }
    return rows;
}

TEST(Compare, SaltLakeAgainstItsTruth) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_EQ(certify(examples / "salt_lake" / "attempt.yaml", run, {"--no-render"}).exit_status,
              0);
    const auto before = contents_of(run);
    const ProcessResult result = runcert(
        {"compare", run.string(), "--truth", (examples / "salt_lake" / "truth.csv").string()});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_EQ(contents_of(run), before);  // it writes nothing
    const YamlValue windows = read_yaml(run / "5-windows.yaml");
    for (const YamlValue& profile : windows["profiles"].list()) {
        const auto rows = table_of(result.output, profile["profile"].text());
        for (const char* name :
             {"raw positions", "v1 [DHD22]", "v2 [DHD22]", "Kalman filter [DHD22]",
              "fixed lag 0.5 s (5 epochs)", "fixed lag 1 s (10 epochs)",
              "fixed lag 2 s (20 epochs)", "fixed lag, full", "smoother, constant acceleration",
              "smoother, Singer acceleration", "smoother of the trajectory", "batch",
              "robust solution", "recorded velocity", "enhanced Kalman filter [EKF]", "certified"})
            ASSERT_TRUE(rows.contains(name)) << name << "\n" << result.output;
        const TableRow& smoother = rows.at("smoother of the trajectory");
        const TableRow& full = rows.at("fixed lag, full");
        EXPECT_EQ(full.by, "d/T");
        for (std::size_t cell = 0; cell < 6; ++cell)  // by one in the last digit shown
            EXPECT_NEAR(full.number(cell), smoother.number(cell), cell < 3 ? 0.0101 : 1.01e-3)
                << cell;
        // The window was chosen on the trajectory.
        const YamlValue best = profile["best"];
        EXPECT_NEAR(smoother.number(0), best["start_time_s"].real(), 1e-9);
        EXPECT_EQ(smoother.cells[1], smoother.cells[2]);
        EXPECT_NEAR(rows.at("certified").number(2), best["speed_m_s"].real() * 3.6, 0.01);
        // What was measured of these methods elsewhere: the smoother is better than v1 and v2, and
        // the paper's filter is late by metres per second while the craft accelerates.
        EXPECT_LT(smoother.number(3), 0.25);
        EXPECT_LT(smoother.number(3), rows.at("v2 [DHD22]").number(3));
        EXPECT_LT(rows.at("v2 [DHD22]").number(3), rows.at("v1 [DHD22]").number(3));
        EXPECT_GT(rows.at("Kalman filter [DHD22]").number(3), 1.0);
        EXPECT_LT(std::abs(smoother.number(5)), 0.1);
        EXPECT_EQ(rows.at("recorded velocity").cells[1], "-");
    }
    EXPECT_NE(result.output.find("Not available: recorded velocity"), std::string::npos);
    EXPECT_NE(result.output.find("Singer: log-likelihood"), std::string::npos);
}

TEST(Compare, WhatCannotBeComparedIsRefused) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_EQ(certify(examples / "salt_lake" / "attempt.yaml", run, {"--no-render"}).exit_status,
              0);
    const auto refused = [&](std::vector<std::string> arguments, const std::string& said) {
        arguments.insert(arguments.begin(), "compare");
        const ProcessResult result = runcert(arguments);
        EXPECT_EQ(result.exit_status, 2) << said;
        EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
        EXPECT_NE(result.errors.find("what to do: "), std::string::npos) << result.errors;
    };
    refused({(folder.path() / "absent").string()}, "no such run folder");
    EXPECT_FALSE(fs::exists(folder.path() / "absent"));
    refused({folder.path().string()}, "attempt.yaml");
    refused({run.string(), "--receiver", "third"}, "primary");
    refused({run.string(), "--truth", (folder.path() / "absent.csv").string()}, "absent.csv");
    const fs::path truth = folder.path() / "truth.csv";
    write_file_atomically(truth, "time_s,east_m,north_m,speed_m_s\n1000,0,0,1\n");
    refused({run.string(), "--truth", truth.string()}, "No epoch");
    write_file_atomically(truth, "time_s,east_m,north_m,speed_m_s\n0.000,0,0,1\n");
    refused({run.string(), "--truth", truth.string()}, "certified window");
    write_file_atomically(truth, "time_s,east_m,north_m,speed_m_s\n0.000,0,zero,1\n");
    refused({run.string(), "--truth", truth.string()}, "truth.csv:2");
    fs::remove(run / "5-windows.yaml");
    refused({run.string()}, "5-windows.yaml");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
