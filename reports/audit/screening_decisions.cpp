#include <fmt/format.h>

#include <cmath>
#include <span>

#include "reports/audit/screening.h"

namespace runcert {
namespace {

using Rows = std::vector<ScreenedEpoch>;

/// Whether the test of a row is that of the break before it.
bool explains_break(const ScreenedEpoch& row) {
    if (!row.usable || !row.break_before || !row.hypothesis) return false;
    switch (*row.break_before) {
        case ArcBreak::step:
            return *row.hypothesis == Hypothesis::step && size_of(row.estimated).has_value();
        case ArcBreak::ramp:
            return *row.hypothesis == Hypothesis::ramp && rate_of(row.estimated).has_value();
        case ArcBreak::time_shift:
            return *row.hypothesis == Hypothesis::time_shift && row.estimated.time_s.has_value();
        default:
            return false;
    }
}

std::optional<std::size_t> used_before(const Rows& rows, std::size_t at) {
    while (at-- > 0)
        if (rows[at].usable && rows[at].arc) return at;
    return std::nullopt;
}

/// Which arc ends, which begins.
std::string arcs_text(const Rows& rows, std::size_t at, std::optional<std::size_t> previous) {
    const auto arc = [](const ScreenedEpoch& row) {
        return row.arc ? fmt::format("arc {}", *row.arc) : std::string("an arc");
    };
    if (!previous) return arc(rows[at]) + " begins";
    return fmt::format("{} ends, {} begins", arc(rows[*previous]), arc(rows[at]));
}

std::string gap(const Rows& rows, std::size_t at, std::optional<std::size_t> previous) {
    if (!previous) return "a gap";
    const auto left_out = static_cast<std::int64_t>(at - *previous - 1);
    const auto gap_ns = rows[at].time.nanoseconds - rows[*previous].time.nanoseconds;
    return fmt::format("a gap: the last epoch used before is {}, {} s earlier, with {} between",
                       rows[*previous].epoch, format_fixed(static_cast<double>(gap_ns) * 1e-9, 3),
                       left_out == 0 ? "none recorded" : counted(left_out, "epoch") + " left out");
}

std::string step(const ScreenedEpoch& row) {
    if (!explains_break(row)) return "a step";
    return fmt::format("a step {}of {} m ({})", row.estimated.up_m ? "in height " : "",
                       format_fixed(*size_of(row.estimated), 3), components(row.estimated));
}

std::string drift(const ScreenedEpoch& row) {
    if (!explains_break(row)) return "a drift of the positions begins or ends";
    return fmt::format("a drift of the positions by {} m/s ({}) begins or ends",
                       format_fixed(*rate_of(row.estimated), 3), rate_components(row.estimated));
}

std::string shift(const ScreenedEpoch& row) {
    if (!explains_break(row)) return "the time stamps jump";
    const double late_s = *row.estimated.time_s;
    return fmt::format("the time stamps jump by {} s (they are {} afterwards)",
                       format_fixed(std::abs(late_s), 4), late_s < 0.0 ? "early" : "late");
}

/// The way that the craft makes in the time by which the stamps jump, from its next two positions:
/// ", about 0.60 m"; empty where they do not tell.
std::string way_of_shift(const Rows& rows, std::size_t at) {
    if (!explains_break(rows[at]) || at + 1 >= rows.size()) return {};
    const ScreenedEpoch& from = rows[at];
    const ScreenedEpoch& to = rows[at + 1];
    const double time_s = to.time.seconds() - from.time.seconds();
    if (!from.east_m || !from.north_m || !to.usable || !to.east_m || !to.north_m || time_s <= 0.0)
        return {};
    const double speed_m_s =
        std::hypot(*to.east_m - *from.east_m, *to.north_m - *from.north_m) / time_s;
    return fmt::format(", about {} m",
                       format_fixed(std::abs(*from.estimated.time_s) * speed_m_s, 2));
}

/// What the break before a row is, and which arcs it parts, without the statistic.
std::string break_text(const Rows& rows, std::size_t at) {
    const ScreenedEpoch& row = rows[at];
    const auto previous = used_before(rows, at);
    const std::string arcs = arcs_text(rows, at, previous);
    const std::string between =
        previous ? fmt::format(" between epochs {} and {}", rows[*previous].epoch, row.epoch)
                 : fmt::format(" before epoch {}", row.epoch);
    const std::string parted = ": the positions before and after it do not belong together; ";
    switch (row.break_before.value()) {
        case ArcBreak::start:
            return arcs;
        case ArcBreak::gap:
            return gap(rows, at, previous) + "; " + arcs;
        case ArcBreak::innovation:
            return "a break" + between +
                   ": the positions after it do not follow from those before; " + arcs;
        case ArcBreak::step:
            return step(row) + between + parted + arcs;
        case ArcBreak::ramp:
            return drift(row) + between + parted + arcs;
        case ArcBreak::time_shift:
            return shift(row) + between + ", or the positions by as much along the track" +
                   way_of_shift(rows, at) + ": at constant speed the two cannot be separated; " +
                   arcs;
    }
    return arcs;
}

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
        "In the order of {}: its lines, or its bytes where it has no lines, are in brackets, "
        "seconds count from its first epoch, ± is one standard uncertainty.",
        subject.recording);
    std::int64_t used = 0;
    std::vector<std::string> entries;
    for (const AuditEntry& entry : audit_entries(table.rows)) {
        const bool is_used = entry.kind == AuditEntry::Kind::used;
        used += is_used ? 1 : 0;
        if (!is_used || all) entries.push_back(entry_text(table, entry, chance));
    }
    const std::string count =
        !all ? counted(used, "epoch") + " used (--all lists each of them)."
             : fmt::format(
                   "{} used: after each the hypothesis that it supports best, the statistic and "
                   "the threshold that this stays below, and the minimal detectable biases there.",
                   counted(used, "epoch"));
    return {paragraph(order), list_of(std::move(entries)), paragraph(count)};
}

}  // namespace runcert
