#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/header.h"

namespace runcert {

/// Why an attempt could not be processed.
struct DayFailure {
    std::string step;
    std::string problem;
    std::string where = {};
    std::string remedy = {};
};

/// A speed as it is to be read, in the rule's unit.
struct DayShown {
    std::string unit;
    std::string speed;
    std::string expanded_uncertainty;
    std::string target = {};  ///< empty where no record is named
};

/// What one rule says of an attempt.
struct DayResult {
    std::string profile;
    std::string outcome;  ///< "beaten", "not_proven", "not_beaten", "not_certifiable"
    std::string reason;
    std::optional<double> speed_mps = {};
    std::optional<double> expanded_uncertainty_mps = {};
    double coverage_factor = 2.0;
    std::optional<double> target_mps = {};
    std::optional<DayShown> shown = {};
    std::string start_utc = {};  ///< empty where the recording's time is relative
    std::optional<double> start_time_s = {};
    std::optional<double> duration_s = {};
    std::vector<std::string> replaced = {};  ///< figures of the rule that the attempt replaced
    /// Of the decision; these since revision 1.1.
    std::optional<double> probability = {};  ///< that the speed reaches the target
    std::optional<double> level = {};        ///< that acceptance needs
    std::int64_t attempts_made = 1;          ///< that this one says it is the best of
};

struct DayCraft {
    std::string name = {};
    std::string craft_class = {};
};

struct AttemptResult {
    std::string id;
    std::string source;
    std::string state;  ///< "done", "failed", "not_processed"
    std::optional<DayFailure> failure = {};
    std::string reason = {};  ///< why it was left out
    std::optional<DayCraft> craft = {};
    std::string report_id = {};
    std::string report = {};              ///< relative to the day's folder
    std::vector<std::string> pages = {};  ///< relative to the day's folder
    std::vector<std::string> notes = {};
    std::vector<DayResult> results = {};

    /// What that rule says of it, or null where it does not claim it.
    const DayResult* by(std::string_view profile) const;
};

/// A place in a ranking.
struct DayPlace {
    std::optional<std::int64_t> rank;  ///< empty where no speed is certified
    std::string id;
    /// Every rank between its own and these has a speed that the measurement does not tell from
    /// its own; empty where not even the next one.
    std::optional<std::int64_t> not_told_apart_up_to = {};
    std::optional<std::int64_t> not_told_apart_down_to = {};
};

struct OutcomeCounts {
    std::int64_t beaten = 0;
    std::int64_t not_proven = 0;
    std::int64_t not_beaten = 0;
    std::int64_t not_certifiable = 0;
};

/// The best of the day's attempts under a rule, judged as the best of so many: the risk that one
/// attempt may take is divided by their number.
struct BestOfDay {
    std::string id;
    std::int64_t attempts = 0;  ///< under the rule, of which it is the best
    double probability = 0.0;
    double level = 0.0;   ///< that the best of so many needs
    bool beaten = false;  ///< whether it does
};

struct DayProfile {
    std::string profile;
    std::string body;
    std::string title;
    OutcomeCounts counts = {};
    std::vector<DayPlace> ranking = {};
    std::optional<BestOfDay> best = {};  ///< of those that beat the record by themselves
};

struct DayCounts {
    std::int64_t attempts = 0;
    std::int64_t done = 0;
    std::int64_t failed = 0;
    std::int64_t not_processed = 0;
    std::int64_t beaten = 0;  ///< those that beat a record by at least one rule
};

/// day.yaml, `schemas/day_results/v1.yaml`.
struct DayResults {
    Header header;
    std::string day;
    DayCounts counts = {};
    std::vector<AttemptResult> attempts = {};
    std::vector<DayProfile> profiles = {};
    std::vector<std::string> notes = {};
};

std::string write_day_results(const DayResults& results);
DayResults read_day_results(std::string_view text, const std::string& where);

}  // namespace runcert
