#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reports/diff/run_causes.h"
#include "reports/diff/table_comparison.h"

namespace runcert {

/// What became of an epoch.
struct EpochChange {
    JoinedRow row;
    std::string a;  ///< "used", "left out: outlier", "used; step before it"
    std::string b;
};

struct EpochDifference {
    std::string receiver;
    std::int64_t rows_a = 0, rows_b = 0, joined = 0;
    std::vector<EpochChange> changes;

    /// How many changed from what to what: "used -> left out: outlier".
    std::map<std::string, std::int64_t> counts() const;
    bool equal() const { return changes.empty() && joined == rows_a && joined == rows_b; }
};

/// The largest changes of one product.
struct ProductDifference {
    std::string file;
    std::string stage;
    std::optional<TableComparison> table;  ///< of a table
    std::vector<ValueDifference> values;   ///< of a document
    bool only_a = false;
    bool only_b = false;

    bool equal() const {
        return !only_a && !only_b && values.empty() && (!table || table->equal());
    }
};

/// All that differs between two run folders. Nothing but what is told apart here decides whether
/// they are equal: not run.yaml, signatures or pages.
struct RunDifference : RunCauses {
    std::vector<EpochDifference> epochs;
    std::vector<Change> windows;
    std::vector<Change> verdicts;
    std::vector<ProductDifference> products;

    bool equal() const;
};

/// Compares two run folders. Failure where one is not a run folder, or holds what cannot be read.
RunDifference difference_of_runs(const std::filesystem::path& a, const std::filesystem::path& b);

/// For people: one line for what is the same, every difference where not. With `all` no list is
/// cut. At most 100 columns.
std::string difference_text(const RunDifference& difference, const std::filesystem::path& a,
                            const std::filesystem::path& b, bool all);

/// For machines, complete.
nlohmann::ordered_json difference_json(const RunDifference& difference);

/// What the windows of two runs (5-windows.yaml) have otherwise, rule by rule, with the difference
/// of speeds in units of their combined expanded uncertainty (k = 2).
std::vector<Change> window_changes(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b,
                                   const std::string& receiver);
/// The outcomes and requirements' states that differ (6-verdict.yaml).
std::vector<Change> verdict_changes(const nlohmann::ordered_json& a,
                                    const nlohmann::ordered_json& b);
/// The epochs whose state differs (3-screened.ecsv), whose names in messages are given.
EpochDifference epoch_difference(std::string_view a, std::string_view b, const std::string& where_a,
                                 const std::string& where_b);

/// An item of a list in the text for people, set in.
std::string list_item(const std::string& text);

}  // namespace runcert
