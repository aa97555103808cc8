#include "reports/certificate/json_standing.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// Those of a rule that replace the report's own; the page's script has the same list.
constexpr const char* texts_of_rule[] = {"outcome_title", "outcome_mark", "tone", "standing_words",
                                         "answered"};

Json rule_json(const RuleStanding& rule) {
    const OutcomeWords words = outcome_words(rule.state);
    Json json{
        {"outcome_title", words.title}, {"outcome_mark", words.mark},
        {"tone", words.tone},           {"standing_words", standing_text(rule.state.standing)},
        {"answered", Json::array()},    {"clauses", Json::object()}};
    for (const ClauseStanding& clause : rule.clauses) {
        json["clauses"][clause.due.clause] = clause_words(clause);
        for (const GivenAnswer& answer : clause.answers)
            json["answered"].push_back(
                fmt::format("{}: {}", clause.due.clause, answer_words(answer)));
        if (clause.contradicted)
            json["answered"].push_back(clause.due.clause + ": contradicted, answered yes and no");
    }
    return json;
}

}  // namespace

Json standing_json(const RunStanding& standing) {
    if (standing.envelopes == 0 && standing.roster_sha256.empty()) return Json::object();
    Json json{{"roster_sha256", standing.roster_sha256},
              {"vouched_words", vouched_words(standing)},
              {"rules", Json::array()}};
    for (const RuleStanding& rule : standing.rules) {
        json["rules"].push_back(rule_json(rule));
        Json& answered = json["rules"].back()["answered"];
        for (const GivenAnswer& one : standing.recomputations)
            answered.push_back(answer_words(one));
        for (const std::string& fault : standing.faults)
            answered.push_back(fault);
    }
    return json;
}

Json with_standing(Json predicate, const Json& standing) {
    if (!standing.contains("rules")) return predicate;
    predicate["vouched_words"] = standing["vouched_words"];
    for (std::size_t i = 0; i < predicate["profiles"].size(); ++i) {
        Json& profile = predicate["profiles"][i];
        const Json& rule = standing["rules"].at(i);
        for (const char* text : texts_of_rule)
            profile[text] = rule[text];
        for (Json& requirement : profile["requirements"])
            if (const auto words = rule["clauses"].find(requirement["clause"].get<std::string>());
                words != rule["clauses"].end())
                requirement["clause_answers"] = *words;
    }
    return predicate;
}

}  // namespace runcert
