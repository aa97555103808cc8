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
void add_decision_rule(const ProfileVerdict& verdict, const Attempt& attempt, Facts& facts) {
    std::string rule = agreement_text(attempt.decision_rule_agreed, verdict.window);
    const SpeedUnit& unit = speed_unit(verdict.shown ? verdict.shown->unit : "km/h");
    for (const std::string& more : decision_sentences(verdict, unit))
        rule += " " + more;
    facts.add("Decision rule", std::move(rule));
}

Facts decision_facts(const ProfileVerdict& verdict, const Attempt& attempt) {
    Facts facts{{{"Outcome", outcome_words(state_of(verdict)).title},
                 {"Standing", standing_text(verdict.standing)},
                 {"Rule", fmt::format("{}; SHA-256 of its text {}", rule_identity_text(verdict),
                                      verdict.rule.sha256)},
                 {"Because", verdict.reason}}};
    if (verdict.record)
        facts.add("Record", fmt::format("{} {}, by: {}", quantity_text(verdict.record->speed),
                                        verdict.record->unit, verdict.record->source));
    if (verdict.window) facts.add("Window", span_text(*verdict.window));
    if (verdict.speed_m_s) {
        const ShownFigures shown = shown_of(verdict, "km/h");
        facts.add("Measured speed",
                  fmt::format("{}; in the file {}, expanded uncertainty {}",
                              measured_speed_text(shown, verdict.coverage_factor),
                              file_speed_text(*verdict.speed_m_s),
                              file_speed_text(verdict.expanded_uncertainty_m_s.value_or(0.0))));
        if (verdict.required_speed_m_s)
            facts.add("Required speed",
                      fmt::format("{} {}; in the file {}", shown.required_speed, shown.unit,
                                  file_speed_text(*verdict.required_speed_m_s)));
        if (verdict.decision)
            facts.add("Conformance",
                      fmt::format("probability {} (at least {} required); acceptance limit {} {}",
                                  probability_text(verdict.decision->probability),
                                  level_text(verdict.decision->level), shown.acceptance_limit,
                                  shown.unit));
    }
    if (verdict.decision) add_decision_rule(verdict, attempt, facts);
    if (verdict.current_subtracted_m_s)
        facts.add("Current", file_speed_text(*verdict.current_subtracted_m_s) + " subtracted");
    return facts;
}

std::string requirement_text(const Requirement& requirement) {
    std::string text =
        fmt::format("{}: {}. {}", requirement.clause, status_text(requirement.status),
                    capitalised(requirement.evidence));
    std::vector<std::string> figures;
    for (const Figure& figure : requirement.figures)
        figures.push_back(figure_text(figure));
    if (!figures.empty()) text += ". Figures: " + listed(figures);
    return text + fmt::format(". Decided by: {}. The clause: {} Source ({}): {}",
                              to_text(requirement.decided_by), requirement.text,
                              to_text(requirement.certainty), requirement.source);
}

FactTable replaced_table(const std::vector<Override>& overrides) {
    FactTable table{.caption = "Figures of the rule that the attempt replaced",
                    .heads = {"figure", "the rule's", "used", "unit", "reason"}};
    for (const Override& each : overrides)
        table.rows.push_back({each.figure, quantity_text(each.rule), quantity_text(each.used),
                              each.unit, each.reason.empty() ? "none given" : each.reason});
    return table;
}

void add_list(Section& part, const char* heading, const std::vector<std::string>& items) {
    if (items.empty()) return;
    part.add(Paragraph{heading});
    part.add(Entries{.items = items});
}

Section rule_verdict(const ProfileVerdict& verdict, const Attempt& attempt) {
    Section part{
        .title = fmt::format("Rule {}: {}, {}", verdict.profile, verdict.title, verdict.body),
        .blocks = {decision_facts(verdict, attempt)}};
    if (verdict.overrides.empty())
        part.add(Paragraph{"The attempt replaced no figure of the rule."});
    else
        part.add(replaced_table(verdict.overrides));
    std::vector<std::string> requirements;
    for (const Requirement& requirement : verdict.requirements)
        requirements.push_back(requirement_text(requirement));
    add_list(part, "Requirements:", requirements);
    if (verdict.indicated) {
        part.add(Paragraph{fmt::format(
            "A window that the recording shows as {} over {} was REFUSED, because:",
            file_speed_text(verdict.indicated->speed_m_s), span_text(verdict.indicated->span))});
        part.add(Entries{.items = verdict.indicated->refusals, .nested = true});
    }
    std::vector<std::string> course;
    for (const Figure& figure : verdict.course)
        course.push_back(figure_text(figure));
    add_list(part, "Course and craft:", course);
    add_list(part, "To be read with it:", verdict.notes);
    return part;
}

}  // namespace

Section check_section(const RunRecord& record, bool all) {
    const std::string title = stage_title("check", {});
    if (!record.verdict) return missing_section(title, record.verdict_file);
    const Verdict& verdict = *record.verdict;
    Section section = product_section(
        record, title, verdict.header, record.verdict_file,
        counted(std::ssize(verdict.profiles), "verdict") + ", of receiver " + verdict.receiver,
        all);
    section.add(parameter_blocks(record.attempt, verdict.header, all));
    for (const ProfileVerdict& each : verdict.profiles)
        section.parts.push_back(rule_verdict(each, record.attempt));
    if (!verdict.statements.empty())
        section.parts.push_back({.title = "What holds for the whole measurement",
                                 .blocks = {Entries{.items = verdict.statements}}});
    return section;
}

}  // namespace runcert
