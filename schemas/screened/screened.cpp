#include "schemas/screened/screened.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace runcert {

namespace {

std::optional<Hypothesis> decided_for(std::optional<ArcBreak> arc_break) {
    if (arc_break == ArcBreak::step) return Hypothesis::step;
    if (arc_break == ArcBreak::ramp) return Hypothesis::ramp;
    if (arc_break == ArcBreak::time_shift) return Hypothesis::time_shift;
    return std::nullopt;
}

/// Counts by the words of what is counted.
template <class Enum>
nlohmann::ordered_json counts_json(const std::map<Enum, std::int64_t>& counts) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [value, count] : counts)
        json[std::string(to_text(value))] = count;
    return json;
}

}  // namespace

bool rests_on(Reason reason, std::string_view what) {
    const std::vector<std::string_view> all = test_of(reason);
    return std::ranges::find(all, what) != all.end();
}

void ScreeningSummary::add(const ScreenedEpoch& row) {
    usable += row.usable ? 1 : 0;
    if (row.arc) arcs = std::max(arcs, *row.arc);
    ++reasons[row.reason];
    first_of.try_emplace(row.reason, row.epoch, row.time);
    if (row.hypothesis && rests_on(row.reason, "decision")) ++decisions[*row.hypothesis];
    if (const auto hypothesis = decided_for(row.break_before)) ++decisions[*hypothesis];
}

ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows) {
    ScreeningSummary summary;
    for (const ScreenedEpoch& row : rows)
        summary.add(row);
    return summary;
}

nlohmann::ordered_json ScreenedTable::summary() const {
    const ScreeningSummary summary = summarise(rows);
    return {{"epochs", rows.size()},
            {"usable", summary.usable},
            {"arcs", summary.arcs},
            {"reasons", counts_json(summary.reasons)},
            {"decisions", counts_json(summary.decisions)}};
}

}  // namespace runcert
