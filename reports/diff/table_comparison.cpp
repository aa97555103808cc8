#include "reports/diff/table_comparison.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "reports/diff/joined_tables.h"
#include "schemas/common/header.h"

namespace runcert {
namespace {

std::string sigma_name(const std::string& column) {
    if (column.starts_with("speed_")) return "sigma_speed";
    constexpr std::string_view robust = "robust_";
    if (column.starts_with(robust)) return "sigma_" + column.substr(robust.size());
    return "sigma_" + column;
}

/// Whether a column says how sure others are, or how far a test was from its threshold.
bool is_uncertainty_column(const std::string& column) {
    // The jerk density is found by a search, whose end moves with the last bits.
    return column.starts_with("sigma_") || column.starts_with("detectable_") ||
           column.starts_with("jerk_density") || column == "statistic" ||
           column == "local_variance_factor";
}

bool is_written_alike(const EcsvColumn& a, const EcsvColumn& b) {
    return a.type == b.type && a.unit == b.unit &&
           (a.type != CellType::real || a.decimals == b.decimals);
}

/// A column that both tables have.
struct JoinedColumn {
    std::size_t a = 0;
    std::size_t b = 0;
    std::optional<std::size_t> sigma;  ///< in the first table
};

std::vector<JoinedColumn> join_columns(const EcsvReader& a, const EcsvReader& b) {
    std::vector<JoinedColumn> joined;
    for (std::size_t i = 0; i < a.columns().size(); ++i)
        if (const auto other = find_column(b, a.columns()[i].name))
            joined.push_back({i, *other, find_column(a, sigma_name(a.columns()[i].name))});
    return joined;
}

std::string shown(const EcsvReader& row, std::size_t column) {
    return row.is_missing(column) ? "empty" : row.text(column);
}

std::optional<CellDifference> compare_cells(const EcsvReader& a, const EcsvReader& b,
                                            const JoinedColumn& column) {
    const EcsvColumn& described = a.columns()[column.a];
    const bool missing = a.is_missing(column.a) || b.is_missing(column.b);
    if (missing ? a.is_missing(column.a) == b.is_missing(column.b)
                : a.text(column.a) == b.text(column.b))
        return std::nullopt;
    CellDifference cell{.column = described.name, .a = shown(a, column.a), .b = shown(b, column.b)};
    const bool number = described.type == CellType::real || described.type == CellType::integer;
    if (missing || !number || b.columns()[column.b].type != described.type) return cell;
    const double difference = b.real(column.b) - a.real(column.a);
    cell.difference = difference;
    const double sigma = column.sigma && !a.is_missing(*column.sigma) ? a.real(*column.sigma) : 0.0;
    if (sigma > 0.0) cell.ratio = std::abs(difference) / sigma;
    // A thousandth of an uncertainty is, of an uncertainty, a thousandth of itself.
    const double of = is_uncertainty_column(described.name) ? std::abs(a.real(column.a)) : sigma;
    cell.tolerated = described.type == CellType::real &&
                     std::abs(difference) <= std::max(last_digit_tolerance(described.decimals),
                                                      tolerated_fraction_of_uncertainty * of);
    return cell;
}

bool is_larger(const CellDifference& cell, const CellDifference& than) {
    if (cell.ratio || than.ratio) return cell.ratio.value_or(-1.0) > than.ratio.value_or(-1.0);
    return cell.difference &&
           (!than.difference || std::abs(*cell.difference) > std::abs(*than.difference));
}

void note(TableComparison& found, ColumnDifference& column, CellDifference cell,
          const std::string& unit) {
    if (!cell.tolerated && !found.first_not_tolerated) found.first_not_tolerated = cell;
    ++column.cells;
    if (column.cells > 1 && !is_larger(cell, column.largest)) return;
    column.column = cell.column;
    column.unit = unit;
    column.largest = std::move(cell);
}

std::vector<ColumnDifference> compare_rows(TableComparison& found, JoinedTables& tables) {
    const std::vector<JoinedColumn> joined = join_columns(tables.a(), tables.b());
    std::vector<ColumnDifference> columns(joined.size());
    while (tables.next())
        for (std::size_t i = 0; i < joined.size(); ++i)
            if (auto cell = compare_cells(tables.a(), tables.b(), joined[i])) {
                cell->row = tables.row();
                note(found, columns[i], std::move(*cell), tables.a().columns()[joined[i].a].unit);
            }
    std::erase_if(columns, [](const ColumnDifference& column) { return column.cells == 0; });
    return columns;
}

constexpr const char* header_members[] = {"schema", "stage", "inputs", "parameters", "attempt"};

YamlValue whole_of(std::string_view text, const std::string& name) {
    if (name.ends_with(".ecsv")) return YamlValue(EcsvReader(text, name).meta(), name);
    return YamlValue(parse_yaml(text, name), name);
}

}  // namespace

bool TableComparison::equal() const {
    return columns_only_a.empty() && columns_only_b.empty() && columns_otherwise.empty() &&
           joined == rows_a && joined == rows_b && columns.empty() && header.empty();
}

bool TableComparison::tolerated() const {
    return columns_only_a.empty() && columns_only_b.empty() && columns_otherwise.empty() &&
           joined == rows_a && joined == rows_b && !first_not_tolerated &&
           std::ranges::all_of(header, &ValueDifference::tolerated);
}

TableComparison compare_tables(std::string_view a, std::string_view b, const std::string& where_a,
                               const std::string& where_b, const ComparisonRules& rules) {
    JoinedTables tables(a, b, where_a, where_b);
    TableComparison found{
        .rows_a = tables.rows_a(), .rows_b = tables.rows_b(), .joined = tables.joined()};
    for (const EcsvColumn& column : tables.a().columns()) {
        const auto other = find_column(tables.b(), column.name);
        if (!other)
            found.columns_only_a.push_back(column.name);
        else if (!is_written_alike(column, tables.b().columns()[*other]))
            found.columns_otherwise.push_back(column.name);
    }
    for (const EcsvColumn& column : tables.b().columns())
        if (!find_column(tables.a(), column.name)) found.columns_only_b.push_back(column.name);
    found.header = value_differences(results_of(a, where_a), results_of(b, where_b), rules);
    found.columns = compare_rows(found, tables);
    found.only_a_line = tables.only_a_line();
    found.only_b_line = tables.only_b_line();
    return found;
}

nlohmann::ordered_json results_of(std::string_view text, const std::string& name) {
    auto results = json_from_yaml(whole_of(text, name));
    for (const char* member : header_members)
        results.erase(member);
    return results;
}

nlohmann::ordered_json header_of(std::string_view text, const std::string& name) {
    const YamlValue whole = whole_of(text, name);
    auto header = nlohmann::ordered_json::object();
    for (const char* member : header_members)
        if (whole[member].exists()) header[member] = json_from_yaml(whole[member]);
    return header;
}

}  // namespace runcert
