#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/text.h"
#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"

namespace runcert {
namespace {

constexpr std::ptrdiff_t shown_at_most = 20;

/// An item of a list, set in.
std::string list_item(const std::string& text) {
    return std::string(4, ' ').append(wrapped(plain_text(text), 8, 4));
}

std::string change_text(const Change& change) {
    std::string text = fmt::format("{}: A {}, B {}", change.what, change.a, change.b);
    return change.note.empty() ? text : fmt::format("{} ({})", text, change.note);
}

std::string group(const char* title, const char* same, const std::vector<Change>& changes) {
    if (changes.empty()) return wrapped(fmt::format("{}: {}.", title, same));
    std::string text =
        wrapped(fmt::format("{}: {}", title, counted(std::ssize(changes), "difference")));
    for (const Change& change : changes)
        text += list_item(change_text(change));
    return text;
}

std::string cut_text(std::ptrdiff_t left) {
    return list_item(fmt::format("and {} more (--all lists them)", counted(left)));
}

std::string epochs_text(const EpochDifference& epochs, bool all) {
    const std::string title = fmt::format("Epochs of receiver {}", epochs.receiver);
    if (epochs.equal())
        return wrapped(fmt::format("{}: what became of them is the same, all {}.", title,
                                   counted(epochs.joined)));
    std::string text = wrapped(fmt::format(
        "{}: {} compared, of another state {}; only in A {}, only in B {}", title,
        counted(epochs.joined), counted(std::ssize(epochs.changes)),
        counted(epochs.rows_a - epochs.joined), counted(epochs.rows_b - epochs.joined)));
    for (const auto& [change, count] : epochs.counts())
        text += list_item(fmt::format("{}: {}", change, counted(count, "epoch")));
    std::ptrdiff_t shown = 0;
    for (const EpochChange& change : epochs.changes) {
        if (!all && shown == shown_at_most) break;
        ++shown;
        const std::string other = change.row.epoch_a == change.row.epoch_b
                                      ? ""
                                      : fmt::format(" (in B {})", change.row.epoch_b);
        text += list_item(fmt::format("epoch {}{}, {} s: A {}, B {}", change.row.epoch_a, other,
                                      format_fixed(change.row.time_s, 3), change.a, change.b));
    }
    if (shown < std::ssize(epochs.changes)) text += cut_text(std::ssize(epochs.changes) - shown);
    return text;
}

std::string size_text(const std::optional<double>& difference, const std::optional<double>& ratio,
                      const std::string& unit) {
    if (!difference) return {};
    std::string text = fmt::format(", {:+.3g}{}{}", *difference, unit.empty() ? "" : " ", unit);
    if (ratio) text += fmt::format(", {:.3g} of its standard uncertainty", *ratio);
    return text;
}

std::string column_text(const ColumnDifference& column) {
    const CellDifference& cell = column.largest;
    return list_item(
        fmt::format("{}: {}; the largest at epoch {}, {} s (line {} in A, {} in B): A {}, B {}{}",
                    column.column, counted(column.cells, "cell"), cell.row.epoch_a,
                    format_fixed(cell.row.time_s, 3), cell.row.line_a, cell.row.line_b, cell.a,
                    cell.b, size_text(cell.difference, cell.ratio, column.unit)));
}

std::string values_text(const std::vector<ValueDifference>& values, bool all) {
    std::string text;
    std::ptrdiff_t shown = 0;
    for (const ValueDifference& value : values) {
        if (!all && shown == shown_at_most) break;
        ++shown;
        text += list_item(fmt::format("{}: A {}, B {}{}", value.path, value.a, value.b,
                                      size_text(value.difference, value.ratio, "")));
    }
    if (shown < std::ssize(values)) text += cut_text(std::ssize(values) - shown);
    return text;
}

std::string product_text(const ProductDifference& product, bool all) {
    if (product.only_a || product.only_b)
        return wrapped(fmt::format("{}: MISSING in {}", product.file, product.only_a ? "B" : "A"));
    if (product.equal()) return wrapped(fmt::format("{}: every value is the same.", product.file));
    if (!product.table)
        return wrapped(fmt::format("{}: {}", product.file,
                                   counted(std::ssize(product.values), "value") +
                                       (product.values.size() == 1 ? " differs" : " differ"))) +
               values_text(product.values, all);
    const TableComparison& table = *product.table;
    std::string text = wrapped(fmt::format(
        "{}: {} compared, {} only in A, {} only in B; they differ in {} and {} of the header",
        product.file, counted(table.joined, "row"), counted(table.rows_a - table.joined),
        counted(table.rows_b - table.joined), counted(std::ssize(table.columns), "column"),
        counted(std::ssize(table.header), "value")));
    if (!table.columns_only_a.empty())
        text += list_item("columns only in A: " + listed(table.columns_only_a));
    if (!table.columns_only_b.empty())
        text += list_item("columns only in B: " + listed(table.columns_only_b));
    for (const ColumnDifference& column : table.columns)
        text += column_text(column);
    return text + values_text(table.header, all);
}

/// A title and its items, cut unless `all`.
std::string group(const std::string& title, const std::vector<std::string>& items, bool all) {
    if (items.empty()) return {};
    std::string text = wrapped(fmt::format("{}: {}", title, counted(std::ssize(items))));
    const std::ptrdiff_t shown =
        all ? std::ssize(items) : std::min(std::ssize(items), shown_at_most);
    for (std::ptrdiff_t i = 0; i < shown; ++i)
        text += list_item(items[static_cast<std::size_t>(i)]);
    if (shown < std::ssize(items))
        text += list_item(
            fmt::format("and {} more; --json has them all", counted(std::ssize(items) - shown)));
    return text;
}

std::string state_words(const std::string& state, const std::optional<DayFailure>& failure) {
    if (state == "done") return "processed";
    if (state == "not_processed") return "left out";
    return failure ? fmt::format("failed at {} ({})", failure->step, failure->problem) : "failed";
}

std::string outcome_text(const std::optional<DayResult>& result) {
    return result ? std::string(words_of(result->outcome)) : "not claimed";
}

/// The figures with the digits of the file, not those to be read: what moved may be small.
std::string speed_words(const DayResult& result) {
    if (!result.speed_m_s) return "no speed";
    std::string text = format_fixed(*result.speed_m_s, 6) + " m/s";
    if (result.expanded_uncertainty_m_s)
        text += fmt::format(" ± {} m/s", format_fixed(*result.expanded_uncertainty_m_s, 6));
    return text;
}

std::string moved_words(const ResultChange& change) {
    if (!change.speed_moved && !change.uncertainty_moved) return {};
    std::string text =
        fmt::format("{} -> {}", speed_words(*change.old_result), speed_words(*change.new_result));
    if (change.moved_by)
        text += fmt::format(", {:+.3g} of its standard uncertainty", *change.moved_by);
    return text;
}

std::vector<std::string> items_of(const DayComparison& comparison, bool outcomes) {
    std::vector<std::string> items;
    for (const ResultChange& change : comparison.results) {
        if (change.outcome_changed != outcomes) continue;
        std::string text = fmt::format("{}, {}: ", change.id, change.profile);
        if (outcomes)
            text += fmt::format("{} -> {}", outcome_text(change.old_result),
                                outcome_text(change.new_result));
        const std::string moved = moved_words(change);
        items.push_back(text + (outcomes && !moved.empty() ? "; " : "") + moved);
    }
    return items;
}

/// A hash by its first digits.
std::string short_value(const std::string& text) {
    constexpr std::size_t digits_shown = 12;
    const bool is_hash =
        text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
    return is_hash ? text.substr(0, digits_shown) : text;
}

void add_causes(std::vector<std::string>& lines, const char* kind,
                const std::vector<Change>& changes) {
    for (const Change& change : changes)
        lines.push_back(fmt::format("{} {}: {} -> {}", kind, change.what, short_value(change.a),
                                    short_value(change.b)));
}

std::vector<std::string> lines_of(const ChangeCauses& causes) {
    if (!causes.unknown.empty()) return {"not known, " + causes.unknown};
    std::vector<std::string> lines;
    add_causes(lines, "input", causes.causes.inputs);
    add_causes(lines, "parameter", causes.causes.parameters);
    add_causes(lines, "attempt", causes.causes.attempt);
    add_causes(lines, "program of", causes.causes.programs);
    if (lines.empty())
        lines.emplace_back(
            "programs, inputs, parameters and attempt are the same: another processor or compiler, "
            "or a file was changed; `runcert verify RUN --recompute` tells");
    return lines;
}

/// Attempts that changed for the same reasons, together, in the order of their first.
std::string causes_text(const DayComparison& comparison, bool all) {
    std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> reasons;
    for (const ChangeCauses& causes : comparison.causes) {
        const std::vector<std::string> lines = lines_of(causes);
        const auto known = std::ranges::find_if(
            reasons, [&](const auto& reason) { return reason.first == lines; });
        if (known == reasons.end())
            reasons.push_back({lines, {causes.id}});
        else
            known->second.push_back(causes.id);
    }
    std::string text;
    for (const auto& [lines, ids] : reasons) {
        std::vector<std::string> named = ids;
        if (!all && std::ssize(named) > shown_at_most) {
            named.resize(shown_at_most);
            named.push_back(counted(std::ssize(ids) - shown_at_most) + " more");
        }
        text += wrapped(plain_text("Why, of " + listed(named) + ":"));
        for (const std::string& line : lines)
            text += list_item(line);
    }
    return text;
}

}  // namespace

std::string difference_text(const RunDifference& difference, const std::filesystem::path& a,
                            const std::filesystem::path& b, bool all) {
    std::string text = wrapped(plain_text(fmt::format("A: {}", a.string()))) +
                       wrapped(plain_text(fmt::format("B: {}", b.string()))) + "\n";
    text += group("Programs", "every file was made by the same in both", difference.programs);
    text += group("Inputs", "the recordings and rules have the same hashes", difference.inputs);
    text += group("Parameters", "the same", difference.parameters);
    text += group("Attempt", "the same", difference.attempt);
    for (const EpochDifference& epochs : difference.epochs)
        text += epochs_text(epochs, all);
    text += group("Windows", "the same", difference.windows);
    text += group("Verdicts", "the same outcomes, and every requirement as in the other",
                  difference.verdicts);
    for (const ProductDifference& product : difference.products)
        text += product_text(product, all);
    return text + (difference.equal() ? "\nNothing differs.\n" : "\nThe runs differ.\n");
}

std::string comparison_text(const DayComparison& comparison, const std::filesystem::path& old_out,
                            const std::filesystem::path& new_out, bool all) {
    std::string text = wrapped(plain_text(fmt::format("Old: {}", old_out.string()))) +
                       wrapped(plain_text(fmt::format("New: {}", new_out.string())));
    text += wrapped(fmt::format(
        "The same: {} of {} in both (state and outcomes; speeds to a tenth of their standard "
        "uncertainty, the smaller of the two; uncertainties to a tenth of themselves).",
        counted(comparison.unchanged), counted(comparison.in_both, "attempt")));
    text += group("Only in the old day", comparison.only_old, all);
    text += group("Only in the new day", comparison.only_new, all);
    std::vector<std::string> states;
    for (const StateChange& change : comparison.states)
        states.push_back(fmt::format("{}: {} -> {}", change.id,
                                     state_words(change.old_state, change.old_failure),
                                     state_words(change.new_state, change.new_failure)));
    text += group("Processed otherwise", states, all);
    text += group("Outcomes that changed", items_of(comparison, true), all);
    text += group("Speeds and uncertainties that moved", items_of(comparison, false), all);
    text += causes_text(comparison, all);
    return text + (comparison.equal() ? "Nothing changed.\n" : "");
}

}  // namespace runcert
