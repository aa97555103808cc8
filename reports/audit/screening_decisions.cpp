#include <fmt/format.h>

#include <span>

#include "reports/audit/screening_parts.h"
#include "reports/audit/words.h"

namespace runcert {
namespace {

/// Where rows stand in the recording: " (lines 1548 to 1557)"; empty where it does not say.
std::string place_of(const ScreenedEpoch& first, const ScreenedEpoch& last) {
    const bool lines = first.source_line && last.source_line;
    const auto number = [lines](const ScreenedEpoch& row) -> std::optional<std::int64_t> {
        if (lines) return *row.source_line;
        return row.source_byte;
    };
    const auto from = number(first), to = number(last);
    if (!from || !to) return {};
    return fmt::format(" ({}{} {})", lines ? "line" : "byte", *from == *to ? "" : "s",
                       one_or_range(fmt::format("{}", *from), fmt::format("{}", *to)));
}

/// "epochs 1531 to 1540 (lines 1548 to 1557), 415.000 s to 416.800 s"
std::string where_of(const ScreenedEpoch& first, const ScreenedEpoch& last) {
    const auto time = [](const ScreenedEpoch& row) {
        return format_fixed(row.time.seconds(), 3) + " s";
    };
    const auto epoch = [](const ScreenedEpoch& row) { return fmt::format("{}", row.epoch); };
    return fmt::format("epoch{} {}{}, {}", first.epoch == last.epoch ? "" : "s",
                       one_or_range(epoch(first), epoch(last)), place_of(first, last),
                       one_or_range(time(first), time(last)));
}

/// How often chance exceeds a threshold; empty where no test was made.
std::string chance_text(const ScreenedTable& table) {
    return table.basis.test_size > 0.0 ? once_in(table.basis.test_size) : "";
}

/// "; statistic 133.3 where 37.0 is exceeded by chance once in 590 million"
std::string statistic_text(std::span<const ScreenedEpoch> rows, const std::string& chance) {
    const std::string statistic =
        range_text(rows, 1, "", [](const ScreenedEpoch& row) { return row.statistic; });
    const std::string threshold =
        range_text(rows, 1, "", [](const ScreenedEpoch& row) { return row.threshold; });
    if (statistic.empty() || threshold.empty()) return {};
    return fmt::format("; statistic {} where {} is {}", statistic, threshold,
                       chance.empty() ? "the threshold" : "exceeded by chance " + chance);
}

std::string detectable_text(const MinimalDetectableBias& error) {
    std::string sizes;
    const auto add = [&](std::string_view name, std::optional<double> size, int decimals,
                         std::string_view unit) {
        if (size)
            sizes += fmt::format("{} {} {} {}", sizes.empty() ? "; finds" : ",", name,
                                 format_fixed(*size, decimals), unit);
    };
    add("position", error.outlier_m, 3, "m");
    add("step", error.step_m, 3, "m");
    add("drift", error.ramp_m_s, 3, "m/s");
    add("time", error.time_s, 4, "s");
    add("height", error.outlier_up_m, 3, "m");
    add("height step", error.step_up_m, 3, "m");
    return sizes;
}

std::string used_text(const ScreenedEpoch& row) {
    std::string text = "used";
    if (explains_break(row))
        text += ", after the break above";
    else if (row.statistic && row.threshold)
        text += fmt::format("; {}{} {} of {}",
                            row.hypothesis ? words_of(*row.hypothesis) : "innovation",
                            row.tested_axes == TestedAxes::vertical ? " (vertical)" : "",
                            format_fixed(*row.statistic, 1), format_fixed(*row.threshold, 1));
    return text + detectable_text(row.detectable);
}

std::string entry_text(const ScreenedTable& table, const AuditEntry& entry,
                       const std::string& chance) {
    const auto rows = std::span<const ScreenedEpoch>(table.rows)
                          .subspan(entry.first, entry.last - entry.first + 1);
    const ScreenedEpoch& row = rows.front();
    const std::string where = where_of(row, rows.back()) + ": ";
    if (entry.kind == AuditEntry::Kind::used) return where + used_text(row);
    if (entry.kind == AuditEntry::Kind::left_out)
        return where + "left out: " + left_out_text(table, entry) +
               (rests_on(row.reason, "chance") ? statistic_text(rows, chance) : "");
    return "before " + where + break_text(table.rows, entry.first) +
           (explains_break(row) ? statistic_text(rows, chance) : "");
}

}  // namespace

std::vector<Block> decision_blocks(const ScreenedTable& table, const AuditSubject& subject,
                                   bool all) {
    const std::string chance = chance_text(table);
    const std::string order = fmt::format(
        "In the order of {}: its lines, or its bytes where it has no lines, "
        "are in brackets, seconds count from its first epoch, ± is one standard "
        "uncertainty",
        subject.recording);
    std::int64_t used = 0;
    Entries entries;
    for (const AuditEntry& entry : audit_entries(table.rows)) {
        const bool is_used = entry.kind == AuditEntry::Kind::used;
        used += is_used ? 1 : 0;
        if (!is_used || all) entries.items.push_back(entry_text(table, entry, chance));
    }
    const std::string count =
        !all
            ? counted(used, "epoch") + " used (--all lists each of them)."
            : fmt::format(
                  "{} used: after each the hypothesis that it supports best, the statistic and the "
                  "threshold that this stays below, and the minimal detectable biases "
                  "there.",
                  counted(used, "epoch"));
    return {Paragraph{order}, std::move(entries), Paragraph{count}};
}

}  // namespace runcert
