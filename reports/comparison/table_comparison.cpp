#include "reports/comparison/table_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/gps_time.h"
#include "schemas/common/header.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

std::optional<std::size_t> find_column(const EcsvReader& table, std::string_view name) {
    const auto found = std::ranges::find(table.columns(), name, &EcsvColumn::name);
    return found == table.columns().end() ? std::nullopt
                                          : std::optional(found - table.columns().begin());
}

/// One of two tables, with what its rows are matched by.
struct Table {
    Table(std::string_view text, const std::string& where) : rows(text, where) {
        const auto time = find_column(rows, "time");
        for (EcsvReader ahead(text, where); ahead.next_row();) {
            times_ns.push_back(time ? ahead.seconds(*time) : std::ssize(times_ns));
            lines.push_back(static_cast<std::int64_t>(ahead.line()));
        }
        const YamlValue first = YamlValue(rows.meta(), where)["first_epoch_gps"];
        if (time && first.exists()) first_epoch_ns = read_gps_time(first).value().nanoseconds();
    }
    /// Steps to a row, counted from 0, that was not passed yet.
    void step_to(std::size_t row) {
        for (; next <= row; ++next)
            rows.next_row();
    }
    std::int64_t epoch() const {
        const auto column = find_column(rows, "epoch");
        return column && !rows.is_missing(*column) ? rows.integer(*column) : 0;
    }

    EcsvReader rows;
    std::optional<std::int64_t> first_epoch_ns = {};
    std::vector<std::int64_t> times_ns = {};  ///< from the first epoch
    std::vector<std::int64_t> lines = {};
    std::size_t next = 0;
};

std::vector<MatchedPlaces> match_rows(const Table& a, Table& b) {
    if (a.first_epoch_ns && b.first_epoch_ns)
        for (std::int64_t& time_ns : b.times_ns)
            time_ns += *b.first_epoch_ns - *a.first_epoch_ns;
    return match_by_key(a.times_ns, b.times_ns);
}

JoinedRow current_row(const Table& a, const Table& b) {
    const auto time = find_column(a.rows, "time");
    return {.epoch_a = a.epoch(),
            .epoch_b = b.epoch(),
            .time_s = time ? a.rows.real(*time) : 0.0,
            .line_a = static_cast<std::int64_t>(a.rows.line()),
            .line_b = static_cast<std::int64_t>(b.rows.line())};
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

/// A column that both tables have.
struct JoinedColumn {
    std::size_t a = 0;
    std::size_t b = 0;
    std::optional<std::size_t> sigma;  ///< in the first table
    ColumnDifference found = {};
};

std::vector<JoinedColumn> join_columns(TableComparison& found, const EcsvReader& a,
                                       const EcsvReader& b) {
    std::vector<JoinedColumn> joined;
    for (std::size_t i = 0; i < a.columns().size(); ++i) {
        const EcsvColumn& column = a.columns()[i];
        const auto other = find_column(b, column.name);
        if (!other) {
            found.columns_only_a.push_back(column.name);
            continue;
        }
        const EcsvColumn& in_b = b.columns()[*other];
        if (column.type != in_b.type || column.unit != in_b.unit ||
            (column.type == CellType::real && column.decimals != in_b.decimals))
            found.columns_otherwise.push_back(column.name);
        joined.push_back({.a = i,
                          .b = *other,
                          .sigma = find_column(a, sigma_name(column.name)),
                          .found = {.column = column.name, .unit = column.unit}});
    }
    for (const EcsvColumn& column : b.columns())
        if (!find_column(a, column.name)) found.columns_only_b.push_back(column.name);
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
                : a.word(column.a) == b.word(column.b))
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

bool is_of_header(std::string_view member) {
    return member == "schema" || member == "stage" || member == "inputs" ||
           member == "parameters" || member == "attempt";
}

}  // namespace

bool TableComparison::equal() const {
    return tolerated() && columns.empty() && header.empty();
}

bool TableComparison::tolerated() const {
    return columns_only_a.empty() && columns_only_b.empty() && columns_otherwise.empty() &&
           joined == rows_a && joined == rows_b && !first_not_tolerated &&
           std::ranges::all_of(header, &ValueDifference::tolerated);
}

TableComparison compare_tables(std::string_view text_a, std::string_view text_b,
                               const std::string& where_a, const std::string& where_b,
                               const ComparisonRules& rules, const DifferentRow& different_row) {
    Table a(text_a, where_a), b(text_b, where_b);
    TableComparison found{.rows_a = std::ssize(a.lines), .rows_b = std::ssize(b.lines)};
    found.header = value_differences(parts_of(text_a, where_a).results,
                                     parts_of(text_b, where_b).results, rules);
    std::vector<JoinedColumn> columns = join_columns(found, a.rows, b.rows);
    for (const MatchedPlaces& at : match_rows(a, b)) {
        if (!at.a || !at.b) {
            auto& first_line = at.a ? found.only_a_line : found.only_b_line;
            if (!first_line) first_line = at.a ? a.lines[*at.a] : b.lines[*at.b];
            continue;
        }
        ++found.joined;
        a.step_to(*at.a);
        b.step_to(*at.b);
        std::optional<JoinedRow> row;  // where anything differs in it
        for (JoinedColumn& column : columns)
            if (auto cell = compare_cells(a.rows, b.rows, column)) {
                if (!row) row = current_row(a, b);
                cell->row = *row;
                if (!cell->tolerated && !found.first_not_tolerated)
                    found.first_not_tolerated = cell;
                ColumnDifference& of = column.found;
                if (++of.cells == 1 || is_larger(*cell, of.largest)) of.largest = std::move(*cell);
            }
        if (row && different_row) different_row(*row, a.rows, b.rows);
    }
    for (JoinedColumn& column : columns)
        if (column.found.cells > 0) found.columns.push_back(std::move(column.found));
    return found;
}

std::size_t column_of(const EcsvReader& table, std::string_view name) {
    if (const auto found = find_column(table, name)) return *found;
    throw Failure(table.where(), fmt::format("the table has no column \"{}\"", name),
                  "The file is not as the program writes it; take the original");
}

ProductParts parts_of(std::string_view text, const std::string& name) {
    const YamlNode whole =
        name.ends_with(".ecsv") ? EcsvReader(text, name).meta() : parse_yaml(text, name);
    const Json members = json_from_yaml(YamlValue(whole, name));
    ProductParts parts;
    for (const auto& [key, value] : members.items())
        (is_of_header(key) ? parts.header : parts.results)[key] = value;
    return parts;
}

}  // namespace runcert
