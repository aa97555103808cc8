#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

constexpr std::ptrdiff_t shown_at_most = 20;

/// Adds a table that has rows, cut unless `all`; it says how many are left out.
void add_cut(Section& section, Block table, bool all, const char* where_all) {
    if (table.rows.empty()) return;
    if (const auto left = std::ssize(table.rows) - shown_at_most; left > 0 && !all) {
        table.rows.resize(shown_at_most);
        table.rows.back().further.push_back(
            fmt::format("and {} more ({})", counted(left), where_all));
    }
    add(section, std::move(table));
}

constexpr const char* option_of_all = "--all lists them";
constexpr const char* json_has_all = "--json has them all";

/// Notes stand in a column of their own where there is a head for them.
Block changes_table(const std::vector<std::string>& heads, const std::vector<Change>& changes,
                    const std::string& title = {}) {
    Block all = table(heads, title);
    for (const Change& change : changes) {
        TableRow& row = add_row(all, {change.what, change.a, change.b});
        if (heads.size() > row.cells.size()) row.cells.push_back(change.note);
    }
    return all;
}

/// What differs of one kind; one sentence where nothing does.
void add_changes(Section& section, const char* title, const char* same,
                 const std::vector<Change>& changes) {
    if (changes.empty()) return add(section, paragraph(fmt::format("{}: {}.", title, same)));
    std::vector<std::string> heads{"", "A", "B"};
    if (!std::ranges::all_of(changes, &std::string::empty, &Change::note)) heads.emplace_back();
    add(section,
        changes_table(heads, changes,
                      fmt::format("{}, {}", title, counted(std::ssize(changes), "difference"))));
}

void add_epochs(Section& section, const EpochDifference& epochs, bool all) {
    const std::string title = fmt::format("Epochs of receiver {}", epochs.receiver);
    if (epochs.equal())
        return add(section, paragraph(fmt::format("{}: what became of them is the same, all {}.",
                                                  title, counted(epochs.joined))));
    Block counts =
        facts({{.name = "Compared", .value = counted(epochs.joined)},
               {.name = "Of another state", .value = counted(std::ssize(epochs.changes))},
               {.name = "Only in A", .value = counted(epochs.rows_a - epochs.joined)},
               {.name = "Only in B", .value = counted(epochs.rows_b - epochs.joined)}},
              title);
    for (const auto& [change, count] : epochs.counts())
        add_fact(counts, change, counted(count, "epoch"));
    add(section, std::move(counts));
    Block changes = table({">Epoch", ">Time", "A", "B"});
    for (const EpochChange& change : epochs.changes) {
        const std::string other = change.row.epoch_a == change.row.epoch_b
                                      ? ""
                                      : fmt::format(" (in B {})", change.row.epoch_b);
        add_row(changes, {fmt::format("{}{}", change.row.epoch_a, other),
                          format_fixed(change.row.time_s, 3) + " s", change.a, change.b});
    }
    add_cut(section, std::move(changes), all, option_of_all);
}

/// "+0.012 m/s, 0.3 of its standard uncertainty".
std::string size_text(const std::optional<double>& difference, const std::optional<double>& ratio,
                      const std::string& unit) {
    if (!difference) return {};
    std::string text = fmt::format("{:+.3g}{}{}", *difference, unit.empty() ? "" : " ", unit);
    if (ratio) text += fmt::format(", {:.3g} of its standard uncertainty", *ratio);
    return text;
}

/// Not every table has epochs, or times.
std::string place_of(const JoinedRow& row) {
    std::string place = fmt::format("line {} in A, {} in B", row.line_a, row.line_b);
    if (row.epoch_a == 0 && row.time_s == 0.0) return place;
    const std::string epoch = row.epoch_a == 0 ? "" : fmt::format("epoch {}, ", row.epoch_a);
    return fmt::format("at {}{} s ({})", epoch, format_fixed(row.time_s, 3), place);
}

Block columns_table(const TableComparison& compared) {
    Block columns = table({"Column", ">Cells", "Largest", "A", "B", "Difference"});
    for (const ColumnDifference& column : compared.columns) {
        const CellDifference& cell = column.largest;
        add_row(columns, {column.column, counted(column.cells), place_of(cell.row), cell.a, cell.b,
                          size_text(cell.difference, cell.ratio, column.unit)});
    }
    return columns;
}

/// A value as it is; the beginning of a long map or list that one of two documents does not have.
std::string shown_value(const std::string& value, bool all) {
    constexpr std::size_t shown_characters = 160;
    const bool whole =
        all || value.size() <= shown_characters || (value.front() != '{' && value.front() != '[');
    return whole ? value : value.substr(0, shown_characters) + "...";
}

void add_values(Section& section, const std::vector<ValueDifference>& values, bool all) {
    std::vector<Change> changes;
    for (const ValueDifference& value : values)
        changes.push_back({value.path, shown_value(value.a, all), shown_value(value.b, all),
                           size_text(value.difference, value.ratio, "")});
    add_cut(section, changes_table({"Value", "A", "B", "Difference"}, changes), all, option_of_all);
}

void add_product(Section& section, const ProductDifference& product, bool all) {
    const auto say = [&](const std::string& what) {
        add(section, paragraph(fmt::format("{}: {}", product.file, what)));
    };
    if (!product.missing_in.empty()) return say("MISSING in " + upper_case(product.missing_in));
    if (product.equal()) return say("every value is the same.");
    if (!product.table) {
        say(fmt::format("{} {}.", counted(std::ssize(product.values), "value"),
                        product.values.size() == 1 ? "differs" : "differ"));
        return add_values(section, product.values, all);
    }
    const TableComparison& compared = *product.table;
    say(fmt::format(
        "{} compared, {} only in A, {} only in B; they differ in {} and {} of the "
        "header.",
        counted(compared.joined, "row"), counted(compared.rows_a - compared.joined),
        counted(compared.rows_b - compared.joined), counted(std::ssize(compared.columns), "column"),
        counted(std::ssize(compared.header), "value")));
    for (const auto& [what, columns] :
         {std::pair{"only in A", &compared.columns_only_a},
          std::pair{"only in B", &compared.columns_only_b},
          std::pair{"of another type, unit or format", &compared.columns_otherwise}})
        if (!columns->empty())
            add(section, paragraph(fmt::format("Columns {}: {}.", what, listed(*columns))));
    if (!compared.columns.empty()) add(section, columns_table(compared));
    add_values(section, compared.header, all);
}

/// The first of them unless `all`, then how many more there are, in these words.
std::vector<std::string> cut(std::vector<std::string> names, bool all, const std::string& words) {
    const std::ptrdiff_t left = std::ssize(names) - shown_at_most;
    if (all || left <= 0) return names;
    names.resize(shown_at_most);
    names.push_back(fmt::format(fmt::runtime(words), counted(left)));
    return names;
}

std::string state_words(const std::string& state, const std::optional<DayFailure>& failure) {
    if (state == "done") return "processed";
    if (state == "not_processed") return "left out";
    return failure ? fmt::format("failed at {} ({})", failure->step, failure->problem) : "failed";
}

/// The outcome, with the speed in the record's unit.
std::string result_words(const std::optional<DayResult>& result) {
    if (!result) return "not claimed";
    std::string text(words_of(result->outcome));
    return result->shown ? fmt::format("{}, {}", text, measured_speed_text(*result->shown)) : text;
}

/// With the digits of the file: what moved may be smaller than what is shown.
std::string in_file(const DayResult& result) {
    if (!result.speed_m_s) return "no speed";
    std::string text = format_fixed(*result.speed_m_s, 6) + " m/s";
    if (result.expanded_uncertainty_m_s)
        text += fmt::format(" ± {} m/s", format_fixed(*result.expanded_uncertainty_m_s, 6));
    return text;
}

Block results_table(const DayComparison& comparison, bool outcomes) {
    Block results = table({"Attempt, rule", "Old", "New"});
    for (const ResultChange& change : comparison.results) {
        if (change.outcome_changed != outcomes) continue;
        TableRow& row =
            add_row(results, {fmt::format("{}, {}", change.id, change.profile),
                              result_words(change.old_result), result_words(change.new_result)});
        if (!change.speed_moved && !change.uncertainty_moved) continue;
        std::string moved = fmt::format("in the files {} -> {}", in_file(*change.old_result),
                                        in_file(*change.new_result));
        if (change.moved_by)
            moved += fmt::format(", {:+.3g} of its standard uncertainty", *change.moved_by);
        row.further.push_back(std::move(moved));
    }
    results.text = fmt::format(
        "{}: {}", outcomes ? "Outcomes that changed" : "Speeds and uncertainties that moved",
        counted(std::ssize(results.rows)));
    return results;
}

/// A hash by its first digits.
std::string short_value(const std::string& text) {
    constexpr std::size_t digits_shown = 12;
    const bool is_hash =
        text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
    return is_hash ? text.substr(0, digits_shown) : text;
}

std::vector<std::string> lines_of(const ChangeCauses& of) {
    if (!of.unknown.empty()) return {"not known, " + of.unknown};
    std::vector<std::string> lines;
    for (const auto& [kind, changes] :
         {std::pair{"input", &of.causes.inputs}, std::pair{"parameter", &of.causes.parameters},
          std::pair{"attempt", &of.causes.attempt}, std::pair{"program of", &of.causes.programs}})
        for (const Change& change : *changes)
            lines.push_back(fmt::format("{} {}: {} -> {}", kind, change.what, short_value(change.a),
                                        short_value(change.b)));
    if (lines.empty())
        lines.emplace_back(
            "programs, inputs, parameters and attempt are the same: another processor or compiler, "
            "or a file was changed; `runcert verify RUN --recompute` tells");
    return lines;
}

/// Attempts that changed for the same reasons, together, in the order of their first.
std::vector<Block> causes_blocks(const DayComparison& comparison, bool all) {
    std::vector<Block> blocks;
    std::vector<std::vector<std::string>> ids;  // of each
    for (const ChangeCauses& causes : comparison.causes) {
        const std::vector<std::string> lines = lines_of(causes);
        const auto known = std::ranges::find(blocks, lines, &Block::items) - blocks.begin();
        if (known == std::ssize(blocks)) {
            blocks.push_back(list_of(lines));
            ids.emplace_back();
        }
        ids[static_cast<std::size_t>(known)].push_back(causes.id);
    }
    for (std::size_t i = 0; i < blocks.size(); ++i)
        blocks[i].text = fmt::format("Why, of {}", listed(cut(ids[i], all, "{} more")));
    return blocks;
}

}  // namespace

Document difference_document(const RunDifference& difference, const std::filesystem::path& a,
                             const std::filesystem::path& b, bool all) {
    Section runs{.anchor = "runs",
                 .blocks = {facts(
                     {{.name = "A", .value = a.string()}, {.name = "B", .value = b.string()}})}};
    Section causes{.anchor = "causes", .title = "Causes"};
    add_changes(causes, "Programs", "every file was made by the same in both",
                difference.causes.programs);
    add_changes(causes, "Inputs", "the recordings and rules have the same hashes",
                difference.causes.inputs);
    add_changes(causes, "Parameters", "the same", difference.causes.parameters);
    add_changes(causes, "Attempt", "the same", difference.causes.attempt);
    Section results{.anchor = "results", .title = "Results"};
    for (const EpochDifference& epochs : difference.epochs)
        add_epochs(results, epochs, all);
    add_changes(results, "Windows", "the same", difference.windows);
    add_changes(results, "Verdicts", "the same outcomes, and every requirement as in the other",
                difference.verdicts);
    Section files{.anchor = "files", .title = "Files"};
    for (const ProductDifference& product : difference.products)
        add_product(files, product, all);
    Section answer{.anchor = "answer",
                   .blocks = {paragraph(
                       difference.equal() ? "Nothing differs." : "The runs differ.", "strong")}};
    return {.title = "Two runs compared",
            .sections = {std::move(runs), std::move(causes), std::move(results), std::move(files),
                         std::move(answer)}};
}

Document comparison_document(const DayComparison& comparison, const std::filesystem::path& old_out,
                             const std::filesystem::path& new_out, bool all) {
    Section days{.anchor = "days"};
    add(days, facts({{.name = "Old", .value = old_out.string()},
                     {.name = "New", .value = new_out.string()},
                     {.name = "The same",
                      .value = fmt::format("{} of {} in both", counted(comparison.unchanged),
                                           counted(comparison.in_both, "attempt"))}}));
    add(days, paragraph("The same are state and outcomes; speeds to a tenth of their standard "
                        "uncertainty, the smaller of the two; uncertainties to a tenth of "
                        "themselves.",
                        "note"));
    for (const auto& [day, ids] :
         {std::pair{"old", &comparison.only_old}, std::pair{"new", &comparison.only_new}})
        if (!ids->empty())
            add(days,
                titled_list(fmt::format("Only in the {} day: {}", day, counted(std::ssize(*ids))),
                            cut(*ids, all, "and {} more (--json has them all)")));
    std::vector<Change> states;
    for (const StateChange& change : comparison.states)
        states.push_back({change.id, state_words(change.old_state, change.old_failure),
                          state_words(change.new_state, change.new_failure)});
    add_cut(days,
            changes_table({"Attempt", "Old", "New"}, states,
                          fmt::format("Processed otherwise: {}", counted(std::ssize(states)))),
            all, json_has_all);
    for (const bool outcomes : {true, false})
        add_cut(days, results_table(comparison, outcomes), all, json_has_all);
    add(days, causes_blocks(comparison, all));
    if (comparison.equal()) add(days, paragraph("Nothing changed.", "strong"));
    return {.title = "Two days compared", .sections = {std::move(days)}};
}

}  // namespace runcert
