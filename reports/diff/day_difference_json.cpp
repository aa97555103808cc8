#include <nlohmann/json.hpp>

#include "reports/diff/day_difference.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<DayFailure>& failure) {
    if (!failure) return nullptr;
    return {{"step", failure->step},
            {"problem", failure->problem},
            {"where", failure->where},
            {"remedy", failure->remedy}};
}

Json json_of(const std::optional<DayResult>& result) {
    if (!result) return nullptr;
    Json json{{"outcome", to_text(result->outcome)}, {"reason", result->reason}};
    if (result->speed_m_s) json["speed_m_s"] = *result->speed_m_s;
    if (result->expanded_uncertainty_m_s)
        json["expanded_uncertainty_m_s"] = *result->expanded_uncertainty_m_s;
    json["coverage_factor"] = result->coverage_factor;
    return json;
}

Json json_of(const ResultChange& change) {
    Json json{{"id", change.id},
              {"profile", change.profile},
              {"outcome_changed", change.outcome_changed},
              {"speed_moved", change.speed_moved},
              {"uncertainty_moved", change.uncertainty_moved},
              {"old", json_of(change.old_result)},
              {"new", json_of(change.new_result)}};
    if (change.moved_by) json["of_standard_uncertainty"] = *change.moved_by;
    return json;
}

Json json_of(const std::vector<Change>& changes) {
    Json list = Json::array();
    for (const Change& change : changes)
        list.push_back({{"what", change.what}, {"old", change.a}, {"new", change.b}});
    return list;
}

Json json_of(const ChangeCauses& causes) {
    Json json{{"id", causes.id},
              {"programs", json_of(causes.causes.programs)},
              {"inputs", json_of(causes.causes.inputs)},
              {"parameters", json_of(causes.causes.parameters)},
              {"attempt", json_of(causes.causes.attempt)}};
    if (!causes.unknown.empty()) json["unknown"] = causes.unknown;
    return json;
}

}  // namespace

Json comparison_json(const DayComparison& comparison) {
    Json json{{"schema", "day-comparison/1.0"},  {"equal", comparison.equal()},
              {"in_both", comparison.in_both},   {"unchanged", comparison.unchanged},
              {"only_old", comparison.only_old}, {"only_new", comparison.only_new},
              {"states", Json::array()},         {"results", Json::array()},
              {"causes", Json::array()}};
    for (const StateChange& change : comparison.states)
        json["states"].push_back({{"id", change.id},
                                  {"old", change.old_state},
                                  {"new", change.new_state},
                                  {"old_failure", json_of(change.old_failure)},
                                  {"new_failure", json_of(change.new_failure)}});
    for (const ResultChange& change : comparison.results)
        json["results"].push_back(json_of(change));
    for (const ChangeCauses& causes : comparison.causes)
        json["causes"].push_back(json_of(causes));
    return json;
}

}  // namespace runcert
