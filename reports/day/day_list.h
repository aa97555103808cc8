#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/day_results/day_results.h"
#include "schemas/verdict/declared.h"

namespace runcert {

/// A file of a run, as it was when its run was done.
struct ListedFile {
    std::string file;  ///< relative to the day's folder
    std::string sha256;
    std::uint64_t bytes = 0;
};

/// What became of one attempt of the day.
struct ListedAttempt {
    std::string id;
    std::string source;
    std::string state;  ///< "done", "failed", "not_processed"
    std::optional<ListedFile> verdict = {};
    std::optional<ListedFile> report = {};
    std::vector<ListedFile> observations = {};  ///< of each receiver
    std::vector<ListedFile> attestations = {};
    std::vector<std::string> pages = {};
    std::vector<std::string> notes = {};
    std::string step = {}, problem = {}, where = {}, remedy = {};  ///< of a failed one
    std::string reason = {};                                       ///< of one that was left out
};

/// The attempts of a day, in the day's own order.
struct DayList {
    std::string day;
    std::vector<ListedAttempt> attempts = {};
    std::vector<std::string> notes = {};
};

/// Reads the list that `runcert batch` hands over, JSON. `where` names it in messages. Failure,
/// with the path of the value, where anything is missing, unknown or of another type; where a file
/// would lie outside of the day's folder; where two attempts with one id are done.
DayList read_day_list(std::string_view text, const std::string& where);

/// What the day takes from a report.json.
struct ReportIdentity {
    std::string report_id;
    std::string attempt;
    std::string craft_name;
    std::string craft_class;
    std::string verdict_sha256 = {};  ///< of the verdict that it reports
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
