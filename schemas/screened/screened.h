#pragma once

#include <map>
#include <utility>

#include "schemas/screened/declared.h"

namespace runcert {

/// Whether an epoch was left out for its time alone.
constexpr bool is_out_of_time(const ScreenedEpoch& row) {
    return row.reason == Reason::repeated || row.reason == Reason::duplicate_time ||
           row.reason == Reason::backward_time;
}

/// Whether a reason rests on a test: its statistic on a threshold that "chance" exceeds, or its
/// being counted as a "decision" for a hypothesis.
bool rests_on(Reason reason, std::string_view what);

/// Rows by reason, arcs and usable rows, counted from the rows; and how often each hypothesis was
/// decided for: by the hypothesis of a row that a test rejected, by the break before a row.
struct ScreeningSummary {
    std::int64_t usable = 0;
    std::int64_t arcs = 0;
    std::map<Reason, std::int64_t> reasons;
    std::map<Reason, std::pair<std::int64_t, ElapsedTime>>
        first_of;  ///< epoch and time of the first
    std::map<Hypothesis, std::int64_t> decisions;

    void add(const ScreenedEpoch& row);
};
ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows);

}  // namespace runcert
