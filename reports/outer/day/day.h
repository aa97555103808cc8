#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/plot/plot.h"
#include "schemas/day_results/day_results.h"

namespace runcert {

/// The attempts that claim a rule, in order: by outcome (beaten, not_proven, not_beaten,
/// not_certifiable), then the faster, then the one whose speed is less uncertain, then by id.
///
/// What is equal but for its id shares a rank, and the next rank counts all of them. What is not
/// certifiable, or has no speed, has no rank. Each rank says how far up and down the speeds are not
/// told apart from its own, without a gap: |v1 - v2| < sqrt(U1^2 + U2^2), the expanded uncertainty
/// of the difference of two independent speeds ([GUM] 5.1.2).
std::vector<DayPlace> ranking_by(std::string_view profile,
                                 const std::vector<AttemptResult>& attempts);

/// The first of a ranking, judged as the best of all attempts that claim the rule; empty where it
/// does not beat the record by itself. The risk 1 - level that an attempt alone may take is that of
/// the rule; an attempt that says it is the best of several has divided it already.
std::optional<BestOfDay> best_by(std::string_view profile,
                                 const std::vector<AttemptResult>& attempts,
                                 const std::vector<DayPlace>& ranking);

/// How many of them have which outcome by that rule.
OutcomeCounts outcomes_by(std::string_view profile, const std::vector<AttemptResult>& attempts);

/// How many attempts are of which state, and how many beat a record.
DayCounts counts_of(const std::vector<AttemptResult>& attempts);

/// The day as a table for spreadsheets: CSV (RFC 4180 with LF), UTF-8, one row for each attempt and
/// rule, one for each attempt without any. Numbers are full figures, units in the columns' names.
/// Text that a spreadsheet would take for a formula gets an apostrophe before it.
std::string day_csv(const DayResults& results);

/// The smoothed speed around the window of an attempt, as its report draws it.
struct WindowCurve {
    std::string profile;
    std::string quantity;     ///< "speed (km/h)"
    double duration_s = 0.0;  ///< of the window
    Curve speed;              ///< over the time from the window's start
};

/// Such curves by the id of the attempt.
using WindowCurves = std::map<std::string, std::vector<WindowCurve>>;

/// The day as one page, a document of blocks: no network, no other file, no script to be read
/// (with one, tables sort). It computes nothing but where to draw: every figure stands in the
/// results, and every curve in a report. Everything from outside is escaped.
std::string day_page(const DayResults& results, const WindowCurves& curves = {});

}  // namespace runcert
