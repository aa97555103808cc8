#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reports/day/day.h"
#include "schemas/day_list/declared.h"
#include "schemas/verdict/declared.h"

namespace runcert {

/// Reads the list that `runcert batch` hands over, JSON. `where` names it in messages. Failure,
/// with the path of the value, where anything is missing, unknown or of another type; where a file
/// would lie outside of the day's folder; where two attempts with one id are done.
DayList read_day_list(std::string_view text, const std::string& where);

/// What the day takes from a report.json, with the speed around the window of each rule.
struct ReportIdentity {
    std::string report_id;
    std::string attempt;
    std::string craft_name;
    std::string craft_class;
    std::string verdict_sha256 = {};  ///< of the verdict that it reports
    std::vector<WindowCurve> curves = {};
};

/// Reads that much of a report, without the rest of it in memory. Failure where it is none.
ReportIdentity read_report_identity(std::string_view text, const std::string& where);

/// An attempt that is done, from its verdict and its report. Failure where the two, or the id under
/// which the day lists it, do not belong together.
AttemptResult summary_of(const ListedAttempt& listed, const Verdict& verdict,
                         const ReportIdentity& report);

/// An attempt that is not done.
AttemptResult summary_of(const ListedAttempt& listed);

/// Adds the rules of a verdict that are not among these, without counts and ranking.
void add_rules(std::vector<DayProfile>& profiles, const Verdict& verdict);

}  // namespace runcert
