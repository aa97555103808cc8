#include "reports/diff/table_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "store/ecsv.h"

namespace runcert {
namespace {

std::optional<std::size_t> find_column(const std::vector<EcsvColumn>& columns,
                                       const std::string& name) {
    for (std::size_t i = 0; i < columns.size(); ++i)
        if (columns[i].name == name) return i;
    return std::nullopt;
}

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
        if (const auto other = find_column(b.columns(), a.columns()[i].name))
            joined.push_back(
                {i, *other, find_column(a.columns(), sigma_name(a.columns()[i].name))});
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

JoinedRow place_of(const EcsvReader& a, const EcsvReader& b) {
    const auto whole = [](const EcsvReader& table) {
        const auto column = find_column(table.columns(), "epoch");
        return column && !table.is_missing(*column) ? table.integer(*column) : 0;
    };
    return {.epoch_a = whole(a),
            .epoch_b = whole(b),
            .time_s = a.real(find_column(a.columns(), "time").value()),
            .line_a = a.line(),
            .line_b = b.line()};
}

void note(TableComparison& found, std::vector<ColumnDifference>& columns, std::size_t index,
          CellDifference cell, const std::string& unit) {
    if (!cell.tolerated && !found.first_not_tolerated) found.first_not_tolerated = cell;
    ColumnDifference& column = columns[index];
    ++column.cells;
    if (column.cells > 1 && !is_larger(cell, column.largest)) return;
    column.column = cell.column;
    column.unit = unit;
    column.largest = std::move(cell);
}

/// Steps to a row, counted from 0, and says at which line the first row was that it passed over.
std::optional<std::size_t> step_to(EcsvReader& table, std::size_t& next, std::size_t row) {
    std::optional<std::size_t> passed;
    for (; next <= row; ++next) {
        (void)table.next_row();
        if (next < row && !passed) passed = table.line();
    }
    return passed;
}

void compare_rows(TableComparison& found, EcsvReader& a, EcsvReader& b,
                  const std::vector<RowPair>& pairs) {
    const std::vector<JoinedColumn> joined = join_columns(a, b);
    std::vector<ColumnDifference> columns(joined.size());
    std::size_t next_a = 0;
    std::size_t next_b = 0;
    const auto keep_first = [](std::optional<std::size_t>& line,
                               std::optional<std::size_t> passed) {
        if (!line) line = passed;
    };
    for (const RowPair& pair : pairs) {
        keep_first(found.only_a_line, step_to(a, next_a, pair.a));
        keep_first(found.only_b_line, step_to(b, next_b, pair.b));
        for (std::size_t i = 0; i < joined.size(); ++i)
            if (auto cell = compare_cells(a, b, joined[i])) {
                cell->row = place_of(a, b);
                note(found, columns, i, std::move(*cell), a.columns()[joined[i].a].unit);
            }
    }
    keep_first(found.only_a_line, a.next_row() ? std::optional(a.line()) : std::nullopt);
    keep_first(found.only_b_line, b.next_row() ? std::optional(b.line()) : std::nullopt);
    std::erase_if(columns, [](const ColumnDifference& column) { return column.cells == 0; });
    found.columns = std::move(columns);
}

}  // namespace

bool TableComparison::equal() const {
    return columns_only_a.empty() && columns_only_b.empty() && columns_otherwise.empty() &&
           joined == rows_a && joined == rows_b && columns.empty() && header.empty();
}

bool TableComparison::tolerated() const {
    return columns_only_a.empty() && columns_only_b.empty() && columns_otherwise.empty() &&
           joined == rows_a && joined == rows_b && !first_not_tolerated &&
           std::ranges::all_of(header,
                               [](const ValueDifference& value) { return value.tolerated; });
}

TableComparison compare_tables(std::string_view a, std::string_view b, const std::string& where_a,
                               const std::string& where_b, const ComparisonRules& rules) {
    EcsvReader table_a(a, where_a);
    EcsvReader table_b(b, where_b);
    TableComparison found;
    for (const EcsvColumn& column : table_a.columns()) {
        const auto other = find_column(table_b.columns(), column.name);
        if (!other)
            found.columns_only_a.push_back(column.name);
        else if (!is_written_alike(column, table_b.columns()[*other]))
            found.columns_otherwise.push_back(column.name);
    }
    for (const EcsvColumn& column : table_b.columns())
        if (!find_column(table_a.columns(), column.name))
            found.columns_only_b.push_back(column.name);
    const bool absolute = says_first_epoch(a, where_a) && says_first_epoch(b, where_b);
    const auto times_a = row_times(a, where_a, absolute);
    const auto times_b = row_times(b, where_b, absolute);
    const auto pairs = join_by_time(times_a, times_b);
    found.rows_a = std::ssize(times_a);
    found.rows_b = std::ssize(times_b);
    found.joined = std::ssize(pairs);
    found.header = value_differences(results_of(a, where_a), results_of(b, where_b), rules);
    compare_rows(found, table_a, table_b, pairs);
    return found;
}

}  // namespace runcert
