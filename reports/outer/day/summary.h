#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "days/day_run.h"
#include "reports/day/day.h"
#include "schemas/verdict/declared.h"

namespace runcert {

/// An attempt of a day, and what became of it.
struct DayOutcome {
    const GivenAttempt& attempt;
    const AttemptOutcome& outcome;
};

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
AttemptResult summary_of(const DayOutcome& of, const Verdict& verdict,
                         const std::string& verdict_sha256, const ReportIdentity& report);

/// An attempt that is not done.
AttemptResult summary_of(const DayOutcome& of);

/// Adds the rules of a verdict that are not among these, without counts and ranking.
void add_rules(std::vector<DayProfile>& profiles, const Verdict& verdict);

}  // namespace runcert
