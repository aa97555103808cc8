#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/prose.h"
#include "reports/certificate/report_html.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// Those of a rule that replace the report's own; the page's script has the same list.
constexpr const char* texts_of_rule[] = {"outcome_title", "outcome_mark", "tone", "standing_words",
                                         "answered"};

void add_line(Json& lines, const std::string& rule, const std::string& words) {
    lines.push_back({{"label", "Rule “" + rule + "”"}, {"value", words}});
}

/// An answer to several clauses is one line.
Json rule_json(const RuleStanding& rule) {
    const OutcomeWords title = outcome_words(rule.state);
    Json json{
        {"outcome_title", title.title}, {"outcome_mark", title.mark},
        {"tone", title.tone},           {"standing_words", standing_text(rule.state.standing)},
        {"answered", Json::array()},    {"clauses", Json::object()}};
    std::vector<std::pair<std::string, std::vector<std::string>>> answered;
    for (const ClauseStanding& clause : rule.clauses) {
        json["clauses"][clause.due.clause] = clause_words(clause);
        for (const std::string& words : clause_words(clause)) {
            auto same =
                std::ranges::find(answered, words, [](const auto& one) { return one.first; });
            if (same == answered.end()) same = answered.insert(same, {words, {}});
            same->second.push_back(clause.due.clause);
        }
    }
    for (const auto& [words, clauses] : answered)
        add_line(json["answered"], rule.profile, fmt::format("{}: {}", words, listed(clauses)));
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
            add_line(answered, rule.profile, answer_words(one));
        for (const std::string& fault : standing.faults)
            add_line(answered, rule.profile, fault);
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
