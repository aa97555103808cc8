#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "recompute.h"
#include "reports/comparison/table_comparison.h"
#include "run/steps.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The stage whose files begin with the same number.
std::string stage_of(const std::string& name) {
    for (const Step& step : steps())
        for (const ProductFile& product : step.products)
            if (product.stem.front() == name.front()) return step.name;
    return "report";
}

std::string values_text(const std::string& old_value, const std::string& new_value) {
    return fmt::format("{} in the folder, {} recomputed", old_value, new_value);
}

/// A value with the largest ratio.
void widen(FileComparison& file, const std::optional<double>& ratio, const std::string& where) {
    // What the search for the noise found may differ by more.
    if (!ratio || *ratio <= file.largest_ratio || *ratio > tolerated_fraction_of_uncertainty)
        return;
    file.largest_ratio = *ratio;
    file.where_largest = where;
}

void judge_values(FileComparison& file, const std::vector<ValueDifference>& values,
                  const std::string& in) {
    for (const ValueDifference& value : values) {
        if (value.tolerated)
            widen(file, value.ratio, fmt::format("{}, {}{}", file.file, in, value.path));
        else if (!file.first)
            file.first = fmt::format("{}{}: {}", in, value.path, values_text(value.b, value.a));
    }
}

/// The first table is the recomputed one.
std::optional<std::string> missing_part(const TableComparison& table) {
    if (!table.columns_only_b.empty())
        return fmt::format("column {}: not there when recomputed", table.columns_only_b.front());
    if (!table.columns_only_a.empty())
        return fmt::format("column {}: not there in the folder", table.columns_only_a.front());
    if (!table.columns_otherwise.empty())
        return fmt::format("column {}: its header states another type, unit or format",
                           table.columns_otherwise.front());
    const auto& cell = table.first_not_tolerated;
    const auto comes_first = [&](const std::optional<std::size_t>& line, std::size_t of_cell) {
        return line && (!cell || *line < of_cell);
    };
    if (comes_first(table.only_b_line, cell ? static_cast<std::size_t>(cell->row.line_b) : 0))
        return fmt::format("line {}, column time: no row of that time when recomputed",
                           *table.only_b_line);
    if (comes_first(table.only_a_line, cell ? static_cast<std::size_t>(cell->row.line_a) : 0))
        return fmt::format("column time: no row in the folder like line {} recomputed",
                           *table.only_a_line);
    return std::nullopt;
}

void judge_table(FileComparison& file, const TableComparison& table) {
    for (const ColumnDifference& column : table.columns) {
        const CellDifference& cell = column.largest;
        if (cell.tolerated)
            widen(file, cell.ratio,
                  fmt::format("{}, line {}, column {}", file.file, cell.row.line_b, cell.column));
    }
    file.first = missing_part(table);
    if (const auto& cell = table.first_not_tolerated; cell && !file.first)
        file.first = fmt::format("line {}, column {}: {}", cell->row.line_b, cell->column,
                                 values_text(cell->b, cell->a));
    judge_values(file, table.header, "header ");
}

Json predicate_of(const std::string& text, const std::string& where) {
    Json report = Json::parse(text, nullptr, false);
    if (!report.is_object() || !report.contains("predicate") || !report["predicate"].is_object())
        throw Failure(where, "this is not a measurement report", "Take the original");
    return std::move(report["predicate"]);
}

/// What the report says of the measurement, without what names programs and bytes; of the page only
/// where the report that is judged has it from this very program.
Json measurement_of(Json predicate, bool made_here) {
    for (const char* member : {"program", "report_id", "files"})
        predicate.erase(member);
    if (!made_here) predicate.erase("page");
    if (predicate.contains("certificate") && predicate["certificate"].is_object())
        for (const char* member : {"unique_identifier", "software"})
            predicate["certificate"].erase(member);
    return predicate;
}

/// What a stage says that it was given: parameters and what it read of the attempt.
Json given_in(const Json& header) {
    Json given = header.value("parameters", Json::object());
    if (header.contains("attempt")) given["attempt"] = header.at("attempt");
    return given;
}

void judge_report(FileComparison& file, const std::string& old_text, const std::string& new_text,
                  const std::string& where) {
    const Json old_report = predicate_of(old_text, where), report = predicate_of(new_text, where);
    const auto made_by = [](const Json& predicate) {
        const Json* program = member_of(&predicate, "program");
        return std::tuple(text_in(program, "version"), text_in(program, "source_revision"),
                          program ? program->value("files", Json()) : Json());
    };
    const bool made_here = made_by(old_report) == made_by(report);
    if (!made_here) file.maker = "another program";
    judge_values(
        file,
        value_differences(measurement_of(report, made_here), measurement_of(old_report, made_here)),
        "");
}

void judge(FileComparison& file, const std::string& old_text, const std::string& new_text,
           const std::string& old_where, const std::string& new_where, bool same_arithmetic) {
    if (file.file == report_file) return judge_report(file, old_text, new_text, old_where);
    const ProductParts old_parts = parts_of(old_text, old_where);
    const ProductParts new_parts = parts_of(new_text, new_where);
    file.maker = maker_of(old_parts.header);
    if (file.maker == maker_of(new_parts.header)) file.maker.clear();
    const bool is_table = file.file.ends_with(".ecsv");
    // Windows and verdict hold the figures that decide.
    const ComparisonRules rules{.declared = &product_fields(file.file),
                                .deciding = same_arithmetic && !is_table};
    if (is_table)
        judge_table(file, compare_tables(new_text, old_text, new_where, old_where, rules));
    else
        judge_values(file, value_differences(new_parts.results, old_parts.results, rules), "");
    // Who made it does not count; by which parameters does: they are given, so to the letter.
    judge_values(file, value_differences(given_in(new_parts.header), given_in(old_parts.header)),
                 "parameter ");
}

/// Whether two files were made from the same bytes, by the same programs of others.
bool have_one_origin(const std::string& a, const std::string& b, const std::string& name) {
    const Json header_a = parts_of(a, name).header;
    const Json header_b = parts_of(b, name).header;
    const auto programs = [](const Json& header) {
        return header.value("stage", Json::object()).value("programs", Json::array());
    };
    return header_a.value("inputs", Json()) == header_b.value("inputs", Json()) &&
           programs(header_a) == programs(header_b);
}

std::size_t first_other_line(std::string_view a, std::string_view b) {
    const auto at = std::ranges::mismatch(a, b).in1;
    return 1 + static_cast<std::size_t>(std::count(a.begin(), at, '\n'));
}

}  // namespace

FileComparison compare_file(const fs::path& run_dir, const fs::path& recomputed,
                            const std::string& name, bool same_arithmetic) {
    FileComparison file{.file = name, .stage = stage_of(name)};
    if (!fs::exists(run_dir / name)) {
        file.first = "missing in the folder";
        return file;
    }
    if (!fs::exists(recomputed / name)) {
        file.first = "not made when recomputed";
        return file;
    }
    const std::string old_text = read_file(run_dir / name);
    const std::string new_text = read_file(recomputed / name);
    file.identical = old_text == new_text;
    if (file.identical) return file;
    try {
        judge(file, old_text, new_text, (run_dir / name).string(), (recomputed / name).string(),
              same_arithmetic);
    } catch (const Failure& failure) {
        file.first = fmt::format("cannot be read: {}", failure.problem());
    }
    // The same binary and the same inputs give the same bytes.
    if (!file.first && file.maker.empty() && same_arithmetic &&
        (name == report_file || have_one_origin(old_text, new_text, name)))
        file.first = fmt::format("line {}: other text than recomputed, of the same values",
                                 first_other_line(old_text, new_text));
    return file;
}

}  // namespace runcert
