#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/plain_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/diff/run_difference.h"

namespace runcert {
namespace {

constexpr std::ptrdiff_t shown_at_most = 20;

/// An indented line of a list.
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
        fmt::format("{}: {}; the largest at epoch {}, {} s (line {} in A, {} in B): A {}, "
                    "B {}{}",
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

}  // namespace

std::string list_item(const std::string& text) {
    return std::string(4, ' ').append(wrapped(plain_text(text), 8, 4));
}

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

}  // namespace runcert
