#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "reports/comparison/value_comparison.h"
#include "store/ecsv.h"

namespace runcert {

/// A product's header, which says who made it from what (schema, stage, inputs, parameters and what
/// was read of the attempt), and what else stands outside a table's rows: its results.
struct ProductParts {
    nlohmann::ordered_json header = nlohmann::ordered_json::object();
    nlohmann::ordered_json results = nlohmann::ordered_json::object();
};
/// Of a table (ECSV) or a document (YAML), by the name's end. Failure where it is neither.
ProductParts parts_of(std::string_view text, const std::string& name);

/// Where the column of that name is; Failure where there is none.
std::size_t column_of(const EcsvReader& table, std::string_view name);

/// Is given every row in which two tables differ.
using DifferentRow =
    std::function<void(const JoinedRow& row, const EcsvReader& a, const EcsvReader& b)>;

/// Compares two tables (ECSV), whose names in messages are given, columns by name, rows by time: on
/// the GPS time scale where both say when their first epoch was, equal times in their order;
/// without a time by their order.
///
/// The uncertainty of column X is sigma_X of the same row; the speeds by other methods share
/// sigma_speed, robust_X is of sigma_X. Resolutions and uncertainties are those of the first;
/// `rules` are for what the header holds. Failure where one is not a table.
TableComparison compare_tables(std::string_view a, std::string_view b, const std::string& where_a,
                               const std::string& where_b, const ComparisonRules& rules = {},
                               const DifferentRow& different_row = {});

}  // namespace runcert
