#include <fmt/format.h>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/screening.h"
#include "reports/audit/sections.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "reports/words/outcome.h"

namespace runcert {
namespace {

/// In capitals where not met, so that it is seen in a page of what is.
std::string status_text(RequirementStatus status) {
    return status == RequirementStatus::not_met ? upper_case(words_of(status))
                                                : std::string(words_of(status));
}

/// The decision rule: who agreed on it, its guard band and what it leaves to chance.
std::string decision_rule_text(const ProfileVerdict& verdict, const Attempt& attempt,
                               const SpeedUnit& unit) {
    std::string rule = agreement_text(attempt.decision_rule_agreed, verdict.window);
    for (const std::string& more : decision_sentences(verdict, unit))
        rule += " " + more;
    return rule;
}

/// The speeds, as they are to be read and as the file has them.
void add_speeds(Block& told, const ProfileVerdict& verdict, const RuleSpeeds& speeds) {
    std::string measured =
        measured_speed_text(shown_of(verdict, speeds.unit().name), verdict.coverage_factor);
    if (const std::string in_file = speeds.measured_in_file(); !in_file.empty())
        measured += "; in the file " + in_file;
    add_fact(told, "Measured speed", std::move(measured));
    if (verdict.required_speed_m_s)
        add_fact(told, "Required speed",
                 speeds.speed_in_file(*verdict.required_speed_m_s, SafeSide::up));
    if (verdict.decision)
        add_fact(told, "Conformance",
                 fmt::format(
                     "probability {} (at least {} required); acceptance limit {}",
                     probability_text(verdict.decision->probability),
                     level_text(verdict.decision->level),
                     speeds.speed_in_file(verdict.decision->acceptance_limit_m_s, SafeSide::up)));
    if (verdict.current_subtracted_m_s)
        add_fact(told, "Current",
                 speeds.speed_in_file(*verdict.current_subtracted_m_s) + " subtracted");
}

Block decision_facts(const ProfileVerdict& verdict, const Attempt& attempt,
                     const RuleSpeeds& speeds) {
    Block told = facts({{"Outcome", outcome_words(state_of(verdict)).title},
                        {"Standing", standing_text(verdict.standing)},
                        {"Rule", fmt::format("{}; SHA-256 of its text {}",
                                             rule_identity_text(verdict), verdict.rule.sha256)},
                        {"Because", sentence(verdict.reason)}});
    if (verdict.record)
        add_fact(told, "Record",
                 fmt::format("{} {}, by: {}", quantity_text(verdict.record->speed),
                             verdict.record->unit, verdict.record->source));
    if (verdict.window) add_fact(told, "Window", span_text(*verdict.window));
    if (verdict.speed_m_s) add_speeds(told, verdict, speeds);
    if (verdict.decision)
        add_fact(told, "Decision rule", decision_rule_text(verdict, attempt, speeds.unit()));
    return told;
}

/// A row with its evidence, figures, text and source beneath it.
void add_requirement(Block& requirements, const Requirement& requirement) {
    TableRow& row = add_row(requirements,
                            {status_text(requirement.status), requirement.clause,
                             std::string(to_text(requirement.decided_by))},
                            std::string(to_text(requirement.status)));
    row.further = {sentence(requirement.evidence)};
    for (const Figure& figure : requirement.figures)
        row.further.push_back(sentence("Figure: " + figure_text(figure)));
    row.further.push_back(fmt::format("The clause: {} Source ({}): {}", sentence(requirement.text),
                                      to_text(requirement.certainty),
                                      sentence(requirement.source)));
}

Block replaced_table(const std::vector<Override>& overrides) {
    Block replaced = table({"figure", ">the rule's", ">used", "unit", "reason"},
                           "Figures of the rule that the attempt replaced");
    for (const Override& each : overrides)
        add_row(replaced, {each.figure, quantity_text(each.rule), quantity_text(each.used),
                           each.unit, each.reason.empty() ? "none given" : each.reason});
    return replaced;
}

std::vector<Block> rule_verdict(const RunRecord& record, const ProfileVerdict& verdict) {
    std::optional<SpeedsToShow> measured;
    if (verdict.speed_m_s)
        measured = {.speed_m_s = *verdict.speed_m_s,
                    .expanded_uncertainty_m_s = verdict.expanded_uncertainty_m_s.value_or(0.0)};
    const RuleSpeeds speeds(record, verdict.profile, measured);
    std::vector<Block> blocks{
        heading(fmt::format("Rule {}: {}, {}", verdict.profile, verdict.title, verdict.body)),
        decision_facts(verdict, record.attempt, speeds),
        verdict.overrides.empty() ? paragraph("The attempt replaced no figure of the rule.")
                                  : replaced_table(verdict.overrides)};
    const auto add_list = [&](std::string title, std::vector<std::string> items) {
        if (!items.empty()) blocks.push_back(titled_list(std::move(title), std::move(items)));
    };
    Block requirements = table({"outcome", "clause", "decided by"}, "Requirements");
    for (const Requirement& requirement : verdict.requirements)
        add_requirement(requirements, requirement);
    if (!requirements.rows.empty()) blocks.push_back(std::move(requirements));
    if (const auto& indicated = verdict.indicated)
        add_list(
            fmt::format("A window that the recording shows as {} over {} was REFUSED, because",
                        speeds.speed_in_file(indicated->speed_m_s), span_text(indicated->span)),
            indicated->refusals);
    std::vector<std::string> course;
    for (const Figure& figure : verdict.course)
        course.push_back(figure_text(figure));
    add_list("Course and craft", std::move(course));
    add_list("To be read with it", verdict.notes);
    return blocks;
}

}  // namespace

std::vector<Block> check_blocks(const RunRecord& record, bool all) {
    const Verdict& verdict = *record.verdict;
    std::vector<Block> blocks = product_blocks(
        record, verdict.header, record.verdict_file,
        counted(std::ssize(verdict.profiles), "verdict") + ", of receiver " + verdict.receiver,
        all);
    append(blocks, parameter_blocks(record.attempt, verdict.header, all));
    for (const ProfileVerdict& each : verdict.profiles)
        append(blocks, rule_verdict(record, each));
    if (!verdict.statements.empty())
        append(blocks,
               {heading("What holds for the whole measurement"), list_of(verdict.statements)});
    return blocks;
}

}  // namespace runcert
