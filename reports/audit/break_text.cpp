#include <fmt/format.h>

#include <cmath>

#include "reports/audit/screening_parts.h"
#include "reports/audit/words.h"

namespace runcert {
namespace {

using Rows = std::vector<ScreenedEpoch>;

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

}  // namespace

bool explains_break(const ScreenedEpoch& row) {
    if (!row.usable || !row.break_before || !row.hypothesis) return false;
    switch (*row.break_before) {
        case ArcBreak::step:
        case ArcBreak::bridged:
            return *row.hypothesis == Hypothesis::step && size_of(row.estimated).has_value();
        case ArcBreak::ramp:
            return *row.hypothesis == Hypothesis::ramp && rate_of(row.estimated).has_value();
        case ArcBreak::time_shift:
            return *row.hypothesis == Hypothesis::time_shift && row.estimated.time_s.has_value();
        default:
            return false;
    }
}

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
        case ArcBreak::bridged:
            return step(row) + between + parted +
                   "it is bridged, with its offset as an unknown of the estimate";
        case ArcBreak::ramp:
            return drift(row) + between + parted + arcs;
        case ArcBreak::time_shift:
            return shift(row) + between + ", or the positions by as much along the track" +
                   way_of_shift(rows, at) + ": at constant speed the two cannot be separated; " +
                   arcs;
    }
    return arcs;
}

}  // namespace runcert
