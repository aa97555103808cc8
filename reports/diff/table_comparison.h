#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/diff/value_comparison.h"

namespace runcert {

/// A row that two tables have in common.
struct JoinedRow {
    std::int64_t epoch_a = 0;
    std::int64_t epoch_b = 0;
    double time_s = 0.0;  ///< as the first table has it
    std::size_t line_a = 0;
    std::size_t line_b = 0;
};

/// A cell that differs.
struct CellDifference {
    JoinedRow row = {};
    std::string column;
    std::string a;  ///< as written; "empty" where missing
    std::string b;
    std::optional<double> difference = {};  ///< b less a, of numbers
    std::optional<double> ratio = {};       ///< its size against the first table's uncertainty
    /// Within a thousandth of the uncertainty (of one: of itself), or a unit of the last digit.
    bool tolerated = false;
};

/// What differs in one column. The largest is that with the largest ratio; without uncertainties
/// the largest difference; of what is no number the first.
struct ColumnDifference {
    std::string column;
    std::string unit;
    std::int64_t cells = 0;
    CellDifference largest;
};

struct TableComparison {
    std::vector<std::string> columns_only_a, columns_only_b;
    std::vector<std::string> columns_otherwise;  ///< of another type, unit or format
    std::int64_t rows_a = 0, rows_b = 0, joined = 0;
    /// Lines of the first row that only one of them has.
    std::optional<std::size_t> only_a_line, only_b_line;
    std::vector<ColumnDifference> columns;              ///< those with a difference, in their order
    std::optional<CellDifference> first_not_tolerated;  ///< in the order of the rows
    std::vector<ValueDifference> header;  ///< of `meta`, but for stage, inputs and parameters

    bool equal() const;
    /// Whether nothing differs by more than is tolerated.
    bool tolerated() const;
};

/// Compares two tables (ECSV), whose names in messages are given. Rows are joined by their time, on
/// the GPS time scale where both say when their first epoch was, equal times in their order;
/// columns by name. The uncertainty of column X is sigma_X of the same row; the speeds by other
/// methods share sigma_speed, robust_X is of sigma_X. Resolutions and uncertainties are those of
/// the first; `rules` are for what the header holds. Failure where one is not a table.
TableComparison compare_tables(std::string_view a, std::string_view b, const std::string& where_a,
                               const std::string& where_b, const ComparisonRules& rules = {});

/// The meta of a table or the whole of a document (YAML), by the name's end, without what says who
/// made it from what: stage, inputs, parameters.
nlohmann::ordered_json results_of(std::string_view text, const std::string& name);
/// Its header: what says that.
nlohmann::ordered_json header_of(std::string_view text, const std::string& name);

/// Where the rows of two tables that have the same time are, in the order of both.
struct RowPair {
    std::size_t a = 0;
    std::size_t b = 0;
};
std::vector<RowPair> join_by_time(const std::vector<std::int64_t>& a,
                                  const std::vector<std::int64_t>& b);

/// The times of a table's rows, ns: on the GPS time scale with `absolute`, which needs the table
/// to say when its first epoch was; else from that.
std::vector<std::int64_t> row_times(std::string_view table, const std::string& where,
                                    bool absolute);
bool says_first_epoch(std::string_view table, const std::string& where);

}  // namespace runcert
