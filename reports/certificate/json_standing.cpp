#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/prose.h"
#include "reports/certificate/report_html.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// The block of that place in the document; null where there is none.
const Json* block_of(const Json& predicate, const std::string& slot) {
    for (const Json& section : predicate.at("document").at("sections"))
        for (const Json& block : section.at("blocks"))
            if (block.value("slot", "") == slot) return &block;
    return nullptr;
}

Json fact(const std::string& name, const std::string& value) {
    return {{"name", name}, {"value", value}};
}

/// An answer to several clauses is one line.
void add_answers(Json& facts, const RuleStanding& rule) {
    std::vector<std::pair<std::string, std::vector<std::string>>> answered;
    for (const ClauseStanding& clause : rule.clauses)
        for (const std::string& words : clause_words(clause)) {
            auto same =
                std::ranges::find(answered, words, [](const auto& one) { return one.first; });
            if (same == answered.end()) same = answered.insert(same, {words, {}});
            same->second.push_back(clause.due.clause);
        }
    for (const auto& [words, clauses] : answered)
        facts.push_back(
            fact("Rule “" + rule.profile + "”", fmt::format("{}: {}", words, listed(clauses))));
}

/// The state of a clause once it was answered, for the eye.
const char* mark_of(const ClauseStanding& clause) {
    if (clause.refused || clause.contradicted) return "not_met";
    return clause.missing == 0 ? "answered" : "attest";
}

/// The facts of a first page with what was answered.
Json answered(Json block, const RuleStanding& rule) {
    for (Json& one : block["facts"])
        for (const ClauseStanding& clause : rule.clauses) {
            if (one.value("clause", "") != clause.due.clause || clause.answers.empty()) continue;
            one["mark"] = mark_of(clause);
            one["value"] = clause_mark_text(clause);
        }
    return block;
}

/// Whether a row is of a clause: rules may have others of the same name.
bool is_of(const Json& row, const DueClause& due) {
    return row.value("clause", "") == due.clause &&
           row["cells"][1].get<std::string>().starts_with(due.clause + ": " + due.text);
}

/// The clauses of all rules with what was answered under each, once where it is the same. What the
/// data refuse under one of the rules stays marked so.
Json answered_under_all(Json block, const std::vector<RuleStanding>& rules) {
    for (Json& row : block["rows"]) {
        std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> said;
        std::string mark = row.value("mark", "") == "not_met" ? "not_met" : "";
        bool is_answered = false;
        for (const RuleStanding& rule : rules)
            for (const ClauseStanding& clause : rule.clauses) {
                if (!is_of(row, clause.due)) continue;
                is_answered = is_answered || !clause.answers.empty();
                const std::string here = mark_of(clause);
                if (mark.empty() || mark == "answered" || here == "not_met") mark = here;
                auto same = std::ranges::find(said, clause_words(clause),
                                              [](const auto& one) { return one.first; });
                if (same == said.end()) same = said.insert(said.end(), {clause_words(clause), {}});
                same->second.push_back(rule.profile);
            }
        if (!is_answered) continue;
        row["mark"] = mark;
        for (const auto& [words, profiles] : said)
            for (const std::string& line : words)
                row["further"].push_back(
                    said.size() == 1 ? line : fmt::format("{}: {}", listed(profiles), line));
    }
    return block;
}

/// `predicate` has the profiles and the document that are shown.
void set_rule(Json& slots, const RuleStanding& rule, const Json& predicate) {
    const auto set = [&](const std::string& place, auto change) {
        const std::string slot = fmt::format("{}/{}", place, rule.profile);
        if (const Json* block = block_of(predicate, slot)) slots[slot] = change(*block);
    };
    const OutcomeWords title = outcome_words(rule.state);
    set("outcome", [&](Json block) {
        const bool several = block.value("look", "") == "strong";
        block["text"] = several ? fmt::format("{}: {}", rule.profile, title.title) : title.title;
        block["sign"] = title.mark;
        if (!several) block["look"] = "outcome_" + title.tone;
        return block;
    });
    set("standing", [&](Json block) {
        block["text"] = fmt::format("Standing: {}.", standing_text(rule.state.standing));
        return block;
    });
    set("requirements", [&](const Json& block) { return answered(block, rule); });
}

}  // namespace

Json standing_json(const RunStanding& standing, const Json& predicate) {
    if (standing.given.envelopes == 0 && standing.roster_sha256.empty()) return Json::object();
    Json json{{"roster_sha256", standing.roster_sha256}, {"slots", Json::object()}};
    if (standing.with_files) json["with_files"] = true;
    const Json& shown = standing.with_files ? predicate.at("with_files") : predicate;
    Json facts = Json::array(
        {fact("Whose word counts", vouched_words(standing) + " The answers are not part of what "
                                                             "the report's signers signed.")});
    for (const RuleStanding& rule : standing.rules) {
        set_rule(json["slots"], rule, shown);
        add_answers(facts, rule);
    }
    if (const Json* block = block_of(shown, "clauses"))
        json["slots"]["clauses"] = answered_under_all(*block, standing.rules);
    for (const GivenAnswer& one : standing.given.whole)
        facts.push_back(fact("Of the whole report", answer_words(one)));
    if (!standing.closing.empty())
        facts.push_back(fact("Closing", fmt::format("{}", fmt::join(standing.closing, " "))));
    for (const std::string& fault : standing.given.faults)
        facts.push_back(fact("Fault", fault));
    if (const Json* block = block_of(shown, "closing")) {
        json["slots"]["closing"] = *block;
        json["slots"]["closing"]["text"] =
            standing.closed
                ? fmt::format("Keys of the roster {} count{}. {}",
                              short_fingerprint(standing.roster_sha256), standing.roles,
                              standing.closed_by)
                : fmt::format("{} {}", vouched_words(standing), fmt::join(standing.closing, " "));
    }
    if (const Json* block = block_of(shown, "answers")) {
        Json& answers = json["slots"]["answers"] = *block;
        answers["facts"] = std::move(facts);
    }
    return json;
}

}  // namespace runcert
