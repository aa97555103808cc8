#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "reports/diff/value_comparison.h"

namespace runcert {

/// Compares two tables (ECSV), whose names in messages are given: rows as `JoinedTables` has them,
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

}  // namespace runcert
