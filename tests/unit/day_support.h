#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "reports/day/day.h"
#include "schemas/verdict/figures.h"

namespace runcert::day {

/// An attempt that is done, with one result by the rule "nalsa".
inline AttemptResult attempt(const std::string& id, Outcome outcome, double speed_m_s,
                             double expanded_m_s) {
    DayResult result{.profile = "nalsa",
                     .outcome = outcome,
                     .reason = "because of " + id,
                     .speed_m_s = speed_m_s,
                     .expanded_uncertainty_m_s = expanded_m_s,
                     .required_speed_m_s = 50.0};
    result.rule_origin = RuleOrigin::built_in;
    result.shown = shown_in({.speed_m_s = speed_m_s,
                             .expanded_uncertainty_m_s = expanded_m_s,
                             .required_speed_m_s = 50.0},
                            speed_unit("m/s"));
    return {.id = id,
            .source = "day.yaml:1",
            .state = "done",
            .craft = DayCraft{"craft of " + id, "land-yacht"},
            .report_id = "0123456789abcdef",
            .report = id + "/report.json",
            .results = {result}};
}

inline AttemptResult without_speed(const std::string& id, Outcome outcome) {
    AttemptResult made = attempt(id, outcome, 0.0, 0.0);
    made.results.front().speed_m_s.reset();
    made.results.front().expanded_uncertainty_m_s.reset();
    return made;
}

/// An attempt that beat the record by itself, with this probability that it did.
inline AttemptResult beaten_with(const std::string& id, double speed_m_s, double probability,
                                 std::int64_t attempts_made = 1) {
    AttemptResult made = attempt(id, Outcome::beaten, speed_m_s, 0.1);
    made.results.front().probability = probability;
    made.results.front().level = 1.0 - 0.025 / static_cast<double>(attempts_made);
    made.results.front().attempts_made = attempts_made;
    return made;
}

inline std::optional<BestOfDay> best_of(const std::vector<AttemptResult>& attempts) {
    return best_by("nalsa", attempts, ranking_by("nalsa", attempts));
}

/// The results of such attempts, counted and ranked.
inline DayResults results_of(std::vector<AttemptResult> attempts) {
    DayResults results{.header = {}, .day = "a day"};
    results.header.stage = "day";
    results.header.program_version = "1.0.0";
    results.header.source_revision = "0123456789ab";
    results.attempts = std::move(attempts);
    results.counts = counts_of(results.attempts);
    for (const AttemptResult& each : results.attempts)
        if (result_by(each, "nalsa") && results.profiles.empty())
            results.profiles.push_back({.profile = "nalsa",
                                        .body = "the body",
                                        .title = "the title",
                                        .counts = outcomes_by("nalsa", results.attempts),
                                        .ranking = ranking_by("nalsa", results.attempts),
                                        .best = best_of(results.attempts)});
    return results;
}

}  // namespace runcert::day
