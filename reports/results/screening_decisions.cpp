#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "core/prose.h"
#include "core/statistics.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

using Rows = std::span<const ScreenedEpoch>;

/// Whether two rows left out one after the other were left out by the same decision: outliers are
/// decided for one by one, a burst or a stretch together.
bool same_decision(const ScreenedEpoch& a, const ScreenedEpoch& b) {
    if (a.reason != b.reason || a.hypothesis != b.hypothesis || a.tested_axes != b.tested_axes)
        return false;
    switch (a.reason) {
        case Reason::outlier:
            return false;
        case Reason::other_fix:
            return a.fix == b.fix;
        case Reason::accuracy_absurd:
            return a.threshold == b.threshold;
        case Reason::burst:
        case Reason::model:
        case Reason::short_arc:
            return a.statistic == b.statistic && a.threshold == b.threshold;
        default:
            return true;
    }
}

/// "3 to 5", or "3" where both are the same.
std::string one_or_range(const std::string& low, const std::string& high) {
    return low == high ? low : low + " to " + high;
}

/// A figure of rows that share a decision; empty where one of them lacks it.
std::string range_text(Rows rows, auto figure, auto text) {
    std::vector<double> figures;
    for (const ScreenedEpoch& row : rows) {
        const std::optional<double> value = std::invoke(figure, row);
        if (!value) return {};
        figures.push_back(std::abs(*value));
    }
    return one_or_range(text(std::ranges::min(figures)), text(std::ranges::max(figures)));
}

/// A size without its sign, times to 0.1 ms.
std::string sized(double size, std::string_view unit) {
    return fmt::format("{} {}", format_fixed(std::abs(size), unit == "s" ? 4 : 3), unit);
}

/// One direction of an estimated error.
struct ErrorPart {
    std::optional<double> EstimatedError::*value;
    std::optional<double> EstimatedError::*sigma;
    std::string_view unit, towards, away;
};

using Error = EstimatedError;
constexpr ErrorPart error_parts[] = {
    {&Error::east_m, &Error::sigma_east_m, "m", "east", "west"},
    {&Error::north_m, &Error::sigma_north_m, "m", "north", "south"},
    {&Error::up_m, &Error::sigma_up_m, "m", "up", "down"},
    {&Error::rate_east_m_s, nullptr, "m/s", "east", "west"},
    {&Error::rate_north_m_s, nullptr, "m/s", "north", "south"},
    {&Error::rate_up_m_s, nullptr, "m/s", "up", "down"},
    {&Error::time_s, nullptr, "s", "late", "early"}};

std::optional<double> size_of(const ScreenedEpoch& row) {
    std::optional<double> size;
    for (const ErrorPart& part : error_parts)
        if (const auto& value = row.estimated.*part.value)
            size = std::hypot(size.value_or(0.0), *value);
    return size;
}

/// "; error 0.183 m (0.174 m ± 0.020 m east, 0.057 m ± 0.020 m south)", "; error 0.500 m to 0.640
/// m"; empty where none was estimated.
std::string error_text(Rows rows) {
    const Error& error = rows.front().estimated;
    std::vector<std::string> parts;
    std::string_view unit;
    for (const ErrorPart& part : error_parts) {
        const auto& value = error.*part.value;
        if (!value) continue;
        unit = part.unit;
        std::string text = sized(*value, unit);
        if (part.sigma && error.*part.sigma) text += " ± " + sized(*(error.*part.sigma), unit);
        parts.push_back(fmt::format("{} {}", text, *value < 0.0 ? part.away : part.towards));
    }
    const std::string size =
        range_text(rows, size_of, [&](double value) { return sized(value, unit); });
    if (parts.empty() || size.empty()) return {};
    if (rows.size() > 1) return "; error " + size;
    if (parts.size() == 1) return "; error " + parts.front();
    return fmt::format("; error {} ({})", size, fmt::join(parts, ", "));
}

/// The unit of the figure that a decision rests on; empty where that has none.
std::string_view unit_of(const ScreenedEpoch& row) {
    const auto of = [&](auto... reasons) { return ((row.reason == reasons) || ...); };
    if (of(Reason::physical_limit))
        return row.hypothesis == Hypothesis::acceleration ? "m/s^2"
               : row.hypothesis == Hypothesis::jerk       ? "m/s^3"
                                                          : "m/s";
    return of(Reason::accuracy_absurd)                          ? "m"
           : of(Reason::backward_time, Reason::old_corrections) ? "s"
           : of(Reason::short_arc)                              ? "epochs"
                                                                : "";
}

/// "; statistic 133.2, threshold 37.0"; empty where there is none.
std::string statistic_text(Rows rows) {
    const ScreenedEpoch& row = rows.front();
    constexpr double least = 1e-6;  // a limit below it is of the determinant of correlations
    if (row.reason == Reason::accuracy_absurd && row.threshold && *row.threshold < least)
        return ", or the correlations are those of no error";
    const bool tested = row.usable || rests_on(row.reason, "chance");
    const auto text = [&](double figure) {
        return tested ? format_fixed(figure, 1) : quantity_text(figure, {}, unit_of(row));
    };
    const std::string statistic = range_text(rows, &ScreenedEpoch::statistic, text);
    const std::string threshold = range_text(rows, &ScreenedEpoch::threshold, text);
    if (statistic.empty() || threshold.empty()) return {};
    return fmt::format("; statistic {}, threshold {}", statistic, threshold);
}

/// "epochs 1531 to 1540 (lines 1548 to 1557), 415.000 s to 416.800 s"; by bytes where the
/// recording has no lines.
std::string where_of(Rows rows) {
    const ScreenedEpoch& first = rows.front();
    const ScreenedEpoch& last = rows.back();
    const auto numbered = [](std::string_view name, std::int64_t from, std::int64_t to) {
        return fmt::format("{}{} {}", name, from == to ? "" : "s",
                           one_or_range(std::to_string(from), std::to_string(to)));
    };
    const auto time = [](const ScreenedEpoch& row) {
        return format_fixed(row.time.seconds(), 3) + " s";
    };
    std::string text = numbered("epoch", first.epoch, last.epoch);
    if (first.source_line && last.source_line)
        text += fmt::format(" ({})", numbered("line", *first.source_line, *last.source_line));
    else if (first.source_byte && last.source_byte)
        text += fmt::format(" ({})", numbered("byte", *first.source_byte, *last.source_byte));
    return fmt::format("{}, {}", text, one_or_range(time(first), time(last)));
}

/// What a test supposed, unless that is said already, and whether of heights.
std::string supposed_text(const ScreenedEpoch& row, std::string_view said) {
    if (!row.hypothesis) return {};
    const bool is_said = to_text(*row.hypothesis) == said;
    return fmt::format("{}{}{}", is_said ? "" : ": ", is_said ? "" : words_of(*row.hypothesis),
                       row.tested_axes == TestedAxes::vertical ? " (vertical)" : "");
}

/// What a jump of the time stamps may be instead, with the way that the craft makes in it as its
/// next two positions show it.
std::string along_track_text(Rows from) {
    std::string way;
    if (from.size() > 1 && from[0].east_m && from[0].north_m && from[1].usable && from[1].east_m &&
        from[1].north_m && from[1].time > from[0].time) {
        const double way_m =
            std::hypot(*from[1].east_m - *from[0].east_m, *from[1].north_m - *from[0].north_m);
        const double time_s = from[1].time.seconds() - from[0].time.seconds();
        way = fmt::format(", about {} m",
                          format_fixed(std::abs(*from[0].estimated.time_s) * way_m / time_s, 2));
    }
    return "; or the positions by as much along the track" + way +
           ": at constant speed the two cannot be separated";
}

/// Whether the test of a row is that of the break before it: what was not accepted has no estimate.
bool explains_break(const ScreenedEpoch& row) {
    return row.usable && row.break_before && row.hypothesis && size_of(row) &&
           to_text(*row.break_before) == to_text(*row.hypothesis);
}

std::string break_text(Rows rows, std::size_t at) {
    const ScreenedEpoch& row = rows[at];
    std::string text = row.arc ? fmt::format("arc {} begins", *row.arc) : "an arc begins";
    for (std::size_t before = at; before-- > 0;)
        if (rows[before].usable && rows[before].arc) {
            const double gap_s = row.time.seconds() - rows[before].time.seconds();
            text += fmt::format(" {} s after epoch {}", format_fixed(gap_s, 3), rows[before].epoch);
            break;
        }
    text += fmt::format(": {}", words_of(*row.break_before));
    if (!explains_break(row)) return text;
    const Rows one = rows.subspan(at, 1);
    text += supposed_text(row, to_text(*row.break_before)) + error_text(one) + statistic_text(one);
    return row.estimated.time_s ? text + along_track_text(rows.subspan(at)) : text;
}

/// A minimal detectable bias.
struct Detectable {
    std::string_view name, unit;
    std::optional<double> MinimalDetectableBias::*size;
};

constexpr Detectable detectables[] = {
    {"outlier", "m", &MinimalDetectableBias::outlier_m},
    {"step", "m", &MinimalDetectableBias::step_m},
    {"drift", "m/s", &MinimalDetectableBias::ramp_m_s},
    {"jump of the time stamps", "s", &MinimalDetectableBias::time_s},
    {"outlier of the height", "m", &MinimalDetectableBias::outlier_up_m},
    {"step of the height", "m", &MinimalDetectableBias::step_up_m}};

std::string used_text(const ScreenedEpoch& row) {
    std::string text = "used";
    if (!explains_break(row)) text += supposed_text(row, "") + statistic_text({&row, 1});
    std::vector<std::string> found;
    for (const Detectable& each : detectables)
        if (const auto& size = row.detectable.*each.size)
            found.push_back(fmt::format("{} {}", each.name, sized(*size, each.unit)));
    return found.empty() ? text : fmt::format("{}; finds {}", text, fmt::join(found, ", "));
}

std::string left_out_text(Rows rows) {
    const ScreenedEpoch& row = rows.front();
    std::string text = fmt::format("left out: {}", words_of(row.reason));
    if (row.reason == Reason::other_fix) text += fmt::format(": {}", words_of(row.fix));
    if (rests_on(row.reason, "decision"))
        text += supposed_text(row, to_text(row.reason)) + error_text(rows);
    return text + statistic_text(rows);
}

/// The sizes over the epochs used.
Block detectable_table(const ScreenedTable& screened) {
    Block block =
        table({"Error", ">Median", ">Largest", ">At epoch", ">Epochs without one"},
              fmt::format("Minimal detectable biases, found with a probability of {} % in the "
                          "direction in which they are hardest to find; what such errors do to a "
                          "speed stands with its window",
                          format_fixed(100.0 * screened.basis.power, 1)));
    for (const auto& [name, unit, size] : detectables) {
        std::vector<double> sizes;
        const ScreenedEpoch* largest = nullptr;
        std::int64_t without = 0;
        for (const ScreenedEpoch& row : screened.rows) {
            const auto& here = row.detectable.*size;
            if (row.usable && here) {
                sizes.push_back(*here);
                if (!largest || here > largest->detectable.*size) largest = &row;
            } else if (row.usable) {
                ++without;
            }
        }
        if (largest)
            add_row(block, {capitalised(name), sized(median(std::move(sizes)), unit),
                            sized(*(largest->detectable.*size), unit),
                            std::to_string(largest->epoch), counted(without)});
    }
    return block;
}

}  // namespace

std::vector<Block> decision_blocks(const ScreenedTable& screened, bool all) {
    const Rows rows(screened.rows);
    std::int64_t used = 0;
    std::vector<std::string> entries;
    const auto add_entry = [&](const char* before, Rows of, const std::string& text) {
        entries.push_back(fmt::format("{}{}: {}", before, where_of(of), text));
    };
    for (std::size_t at = 0; at < rows.size(); ++at) {
        const Rows one = rows.subspan(at, 1);
        if (rows[at].break_before) add_entry("before ", one, break_text(rows, at));
        if (rows[at].usable) {
            ++used;
            if (all) add_entry("", one, used_text(rows[at]));
            continue;
        }
        const std::size_t first = at;
        while (at + 1 < rows.size() && !rows[at + 1].usable && !rows[at + 1].break_before &&
               same_decision(rows[at], rows[at + 1]))
            ++at;
        const Rows together = rows.subspan(first, at + 1 - first);
        add_entry("", together, left_out_text(together));
    }
    std::vector<Block> blocks{
        heading("Decisions"),
        paragraph(
            "In the order of the recording, with its lines (bytes, if it has no lines) in "
            "brackets. "
            "Seconds count from its first epoch; ± is one standard uncertainty. If it cannot be "
            "decided which positions drift, those on both sides are left out."),
        list_of(std::move(entries)),
        paragraph(counted(used, "epoch") +
                  (all ? " used: after each the hypothesis that it supports best, and the minimal "
                         "detectable biases there."
                       : " used (--all lists each of them)."))};
    Block detectable = detectable_table(screened);
    blocks.push_back(detectable.rows.empty()
                         ? paragraph("No epoch used has a minimal detectable bias.")
                         : std::move(detectable));
    return blocks;
}

}  // namespace runcert
