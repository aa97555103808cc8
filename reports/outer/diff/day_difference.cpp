#include "reports/diff/day_difference.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "reports/diff/run_difference.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* day_file = "day.yaml";

/// What tells one failure from another.
std::pair<std::string, std::string> failure_text(const std::optional<DayFailure>& failure) {
    return failure ? std::pair(failure->step, failure->problem)
                   : std::pair<std::string, std::string>();
}

/// 0 where the result states none.
double standard_uncertainty(const DayResult& result) {
    if (!result.expanded_uncertainty_m_s || !(result.coverage_factor > 0.0)) return 0.0;
    return *result.expanded_uncertainty_m_s / result.coverage_factor;
}

/// Sets what moved of a result that both days have.
void compare_speeds(ResultChange& change) {
    const DayResult &from = *change.old_result, &to = *change.new_result;
    const double u_old = standard_uncertainty(from), u_new = standard_uncertainty(to);
    const double smaller = std::min(u_old, u_new);
    if (!from.speed_m_s || !to.speed_m_s || !(smaller > 0.0)) {
        change.speed_moved = from.speed_m_s != to.speed_m_s;
        return;
    }
    change.moved_by = (*to.speed_m_s - *from.speed_m_s) / smaller;
    change.speed_moved = std::abs(*change.moved_by) > moved_fraction_of_uncertainty;
    change.uncertainty_moved = std::abs(u_new - u_old) > moved_fraction_of_uncertainty * smaller;
}

void compare_rule(DayComparison& comparison, const std::string& profile, const AttemptResult& from,
                  const AttemptResult& to) {
    ResultChange change{.id = from.id, .profile = profile};
    if (const DayResult* result = result_by(from, profile)) change.old_result = *result;
    if (const DayResult* result = result_by(to, profile)) change.new_result = *result;
    const bool both = change.old_result && change.new_result;
    change.outcome_changed = !both || change.old_result->outcome != change.new_result->outcome;
    if (both) compare_speeds(change);
    if (change.outcome_changed || change.speed_moved || change.uncertainty_moved)
        comparison.results.push_back(std::move(change));
}

void compare_attempt(DayComparison& comparison, const AttemptResult& from,
                     const AttemptResult& to) {
    const std::size_t before = comparison.states.size() + comparison.results.size();
    if (from.state != to.state || failure_text(from.failure) != failure_text(to.failure)) {
        comparison.states.push_back({from.id, from.state, to.state, from.failure, to.failure});
    } else {
        for (const DayResult& result : from.results)
            compare_rule(comparison, result.profile, from, to);
        for (const DayResult& result : to.results)
            if (!result_by(from, result.profile))
                compare_rule(comparison, result.profile, from, to);
    }
    ++comparison.in_both;
    if (comparison.states.size() + comparison.results.size() == before) ++comparison.unchanged;
}

DayResults read_day(const fs::path& out) {
    const fs::path file = out / day_file;
    if (!fs::is_regular_file(file))
        throw Failure(file.string(), "there is no such file: this is not the folder of a day",
                      "Name the folder that `runcert batch` was given with --out");
    return read_day_results(read_file(file), file.string());
}

ChangeCauses causes_of(const std::string& id, const fs::path& old_out, const fs::path& new_out) {
    ChangeCauses found{.id = id};
    try {
        found.causes = causes_between(old_out / id, new_out / id);
    } catch (const Failure& failure) {
        found.unknown = failure.where() + ": " + failure.problem();
    }
    return found;
}

}  // namespace

bool DayComparison::equal() const {
    return only_old.empty() && only_new.empty() && states.empty() && results.empty();
}

DayComparison compare_results(const DayResults& old_day, const DayResults& new_day) {
    const AttemptsById then = attempts_by_id(old_day), now = attempts_by_id(new_day);
    DayComparison comparison;
    for (const AttemptResult& attempt : old_day.attempts)
        if (then.at(attempt.id) == &attempt && !now.contains(attempt.id))
            comparison.only_old.push_back(attempt.id);
    for (const AttemptResult& attempt : new_day.attempts) {
        if (now.at(attempt.id) != &attempt) continue;
        if (const auto before = then.find(attempt.id); before != then.end())
            compare_attempt(comparison, *before->second, attempt);
        else
            comparison.only_new.push_back(attempt.id);
    }
    return comparison;
}

DayComparison compare_days(const fs::path& old_out, const fs::path& new_out) {
    DayComparison comparison = compare_results(read_day(old_out), read_day(new_out));
    for (const ResultChange& change : comparison.results)
        if (comparison.causes.empty() || comparison.causes.back().id != change.id)
            comparison.causes.push_back(causes_of(change.id, old_out, new_out));
    return comparison;
}

nlohmann::ordered_json comparison_json(const DayComparison& comparison) {
    nlohmann::ordered_json json{{"schema", "day-comparison/1.0"}};
    json.update(members_json(comparison));
    // Of days it is the old and the new.
    for (auto& causes : json["causes"])
        for (const char* kind : {"programs", "inputs", "parameters", "attempt"})
            for (auto& change : causes[kind])
                change = {{"what", change["what"]}, {"old", change["a"]}, {"new", change["b"]}};
    return json;
}

}  // namespace runcert
