#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "recompute.h"
#include "reports/diff/table_comparison.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"
#include "store/program.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string stage_of(const std::string& name) {
    switch (name.front()) {
        case '1':
            return "import";
        case '2':
            return "enu";
        case '3':
            return "screen";
        case '4':
            return "smooth";
        case '5':
            return "window";
        case '6':
            return "check";
        default:
            return "report";
    }
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

bool is_sentence(const std::string& text) {
    constexpr std::ptrdiff_t least_blanks = 3;
    return std::ranges::count(text, ' ') >= least_blanks;
}

/// The numbers in a text, as it has them.
std::set<std::string> numbers_in(const std::string& text) {
    std::set<std::string> numbers;
    std::string number;
    for (const char c : text + ' ') {
        const bool digit = c >= '0' && c <= '9';
        if (digit || (c == '.' && !number.empty())) {
            number += c;
            continue;
        }
        while (number.ends_with('.'))
            number.pop_back();
        if (!number.empty()) numbers.insert(number);
        number.clear();
    }
    return numbers;
}

std::size_t decimals_of(const std::string& number) {
    const std::size_t point = number.find('.');
    return point == std::string::npos ? 0 : number.size() - point - 1;
}

/// Whether two texts may be one figure, rounded to other decimals: at most one unit of the last
/// place of the coarser apart.
bool may_be_one_figure(const std::string& a, const std::string& b) {
    if (a == b) return true;
    const std::size_t coarser = std::min(decimals_of(a), decimals_of(b));
    const auto one = parse_double(a), other = parse_double(b);
    if (decimals_of(a) == decimals_of(b) || !one || !other) return false;
    return coarser == 0 ? *one == *other
                        : std::abs(*one - *other) <=
                              std::pow(10.0, -static_cast<double>(coarser)) * (1.0 + 1e-9);
}

/// Whether a sentence of another program may be this one's in other words: it has no number that
/// this one's has not, but for its decimals.
bool may_be_reworded(const std::string& recomputed, const std::string& in_folder) {
    if (!is_sentence(recomputed) || !is_sentence(in_folder)) return false;
    const std::set<std::string> known = numbers_in(recomputed);
    return std::ranges::all_of(numbers_in(in_folder), [&](const std::string& number) {
        return std::ranges::any_of(
            known, [&](const std::string& own) { return may_be_one_figure(own, number); });
    });
}

void judge_values(FileComparison& file, const std::vector<ValueDifference>& values,
                  const std::string& in) {
    for (const ValueDifference& value : values) {
        if (file.other_program && may_be_reworded(value.a, value.b)) {
            if (file.reworded++ == 0) file.first_reworded = in + value.path;
        } else if (value.tolerated)
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
    if (comes_first(table.only_b_line, cell ? cell->row.line_b : 0))
        return fmt::format("line {}, column time: no row of that time when recomputed",
                           *table.only_b_line);
    if (comes_first(table.only_a_line, cell ? cell->row.line_a : 0))
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

/// What a row of a list is called: its label, or of a figure its kind and title; else empty.
std::string label_of(const Json& row) {
    if (!row.is_object()) return {};
    if (row.contains("label")) return row.at("label").dump();
    return row.contains("figure") ? row.at("figure").dump() + row.value("figure_title", "")
                                  : std::string();
}

bool are_labelled(const Json& rows) {
    return rows.is_array() &&
           std::ranges::none_of(rows, [](const Json& row) { return label_of(row).empty(); });
}

/// What this program says, as far as another one's file says anything of it: members of the same
/// name, and rows of the same label.
Json as_far_as_said(const Json& recomputed, const Json& in_folder) {
    if (recomputed.is_object() && in_folder.is_object()) {
        Json said = Json::object();
        for (const auto& [name, value] : recomputed.items())
            if (in_folder.contains(name)) said[name] = as_far_as_said(value, in_folder.at(name));
        return said;
    }
    Json said = Json::array();
    if (are_labelled(recomputed) && are_labelled(in_folder)) {
        for (const Json& row : in_folder)
            for (const Json& own : recomputed)
                if (label_of(own) == label_of(row)) {
                    said.push_back(as_far_as_said(own, row));
                    break;
                }
        return said;
    }
    if (!recomputed.is_array() || !in_folder.is_array() || recomputed.size() != in_folder.size())
        return recomputed;
    for (std::size_t i = 0; i < recomputed.size(); ++i)
        said.push_back(as_far_as_said(recomputed[i], in_folder[i]));
    return said;
}

/// What must be the same to the letter: parameters are given, and a report follows from its files.
void judge_exact(FileComparison& file, const Json& recomputed, const Json& in_folder,
                 const std::string& in) {
    auto differences = value_differences(recomputed, in_folder);
    for (ValueDifference& value : differences)
        value.tolerated = false;
    judge_values(file, differences, in);
}

bool is_of_this_program(const Json& predicate) {
    const Json program = predicate.value("program", Json::object());
    return program.value("version", "") == program_version() &&
           program.value("source_revision", "") == source_revision();
}

Json predicate_of(const std::string& text, const std::string& where) {
    Json report = Json::parse(text, nullptr, false);
    if (!report.is_object() || !report.contains("predicate") || !report["predicate"].is_object())
        throw Failure(where, "this is not a measurement report", "Take the original");
    return std::move(report["predicate"]);
}

/// What the report says of the measurement, without what names programs and bytes; of the page only
/// where the report that is judged has it from this very program. The recomputed report has the
/// hashes of drawings from the other.
Json measurement_of(Json predicate, bool made_here) {
    for (const char* member : {"program", "report_id", "files"})
        predicate.erase(member);
    if (!made_here)
        for (const char* member : {"page", "schema"})
            predicate.erase(member);
    if (predicate.contains("certificate") && predicate["certificate"].is_object())
        for (const char* member : {"unique_identifier", "software"})
            predicate["certificate"].erase(member);
    if (predicate.contains("method") && predicate["method"].is_object())
        for (Json& stage : predicate["method"]["stages"]) {
            stage.erase("stage_version");
            stage.erase("stage_revision");
        }
    return predicate;
}

std::string maker_of(const std::string& text, const std::string& where) {
    const Json header = header_of(text, where);
    const Json stage = header.value("stage", Json::object());
    const std::string version = stage.value("version", "");
    const std::string revision = stage.value("source_revision", "");
    if (version == program_version() && revision == source_revision()) return {};
    return fmt::format("runcert {}, source {}", version, revision);
}

/// What a stage says that it was given: parameters and what it read of the attempt.
Json given_in(const Json& header) {
    Json given = header.value("parameters", Json::object());
    if (header.contains("attempt")) given["attempt"] = header.at("attempt");
    return given;
}

bool is_of_earlier_revision(const Json& predicate) {
    return predicate.value("schema", Json::object()).value("version", "") !=
           report_field_table().version();
}

/// Of a report of revision 1.0, the figures that its pages showed largest, where later ones have
/// them: beside the others of the verdict.
Json with_headlines(Json said, const Json& first_revision) {
    const Json& profiles = first_revision["profiles"];
    for (std::size_t i = 0; i < profiles.size() && i < said["profiles"].size(); ++i) {
        const Json headline = profiles[i].value("headline", Json::object());
        for (const char* name : {"speed", "required_speed", "acceptance_limit"})
            if (const auto figure = headline.find(fmt::format("headline_{}", name));
                figure != headline.end())
                said["profiles"][i]["shown"][name] = *figure;
    }
    return said;
}

void judge_report(FileComparison& file, const std::string& old_text, const std::string& new_text,
                  const std::string& where) {
    const Json old_report = predicate_of(old_text, where);
    const bool made_here = is_of_this_program(old_report);
    if (!made_here) file.maker = "another program";
    file.other_program = !made_here;
    const Json recomputed = measurement_of(predicate_of(new_text, where), made_here);
    Json in_folder = measurement_of(old_report, made_here);
    // What an earlier revision said beside its figures stands in the document of later ones.
    if (is_of_earlier_revision(old_report))
        in_folder = with_headlines(as_far_as_said(in_folder, recomputed), old_report);
    judge_exact(file, made_here ? recomputed : as_far_as_said(recomputed, in_folder), in_folder,
                "");
}

/// Windows and verdict hold the figures that decide.
ComparisonRules rules_for(const std::string& name, bool same_arithmetic) {
    return {.declared = &product_fields(name),
            .deciding = same_arithmetic && name.ends_with(".yaml")};
}

void judge_results(FileComparison& file, const Json& recomputed, const Json& in_folder,
                   const ComparisonRules& rules) {
    judge_values(
        file,
        value_differences(!file.other_program ? recomputed : as_far_as_said(recomputed, in_folder),
                          in_folder, rules),
        "");
}

void judge(FileComparison& file, const std::string& old_text, const std::string& new_text,
           const std::string& old_where, const std::string& new_where, bool same_arithmetic) {
    if (file.file == report_file) return judge_report(file, old_text, new_text, old_where);
    file.maker = maker_of(old_text, old_where);
    file.other_program = !file.maker.empty();
    const ComparisonRules rules = rules_for(file.file, same_arithmetic);
    if (file.file.ends_with(".ecsv"))
        judge_table(file, compare_tables(new_text, old_text, new_where, old_where, rules));
    else
        judge_results(file, results_of(new_text, new_where), results_of(old_text, old_where),
                      rules);
    // Who made it does not count; by which parameters does. Another program may not have said all
    // that this one says, of what was the same.
    const Json old_given = given_in(header_of(old_text, old_where));
    const Json new_given = given_in(header_of(new_text, new_where));
    judge_exact(file, !file.other_program ? new_given : as_far_as_said(new_given, old_given),
                old_given, "parameter ");
}

/// Whether two files were made from the same bytes, by the same programs of others.
bool have_one_origin(const std::string& a, const std::string& b, const std::string& name) {
    const Json header_a = header_of(a, name);
    const Json header_b = header_of(b, name);
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
