#include "stages/check/requirements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/failure.h"
#include "core/figures.h"
#include "core/speed_unit.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

bool asks(const std::vector<Clause>& clauses, Computation computation) {
    return std::ranges::find(clauses, computation, &Clause::decided_by) != clauses.end();
}

/// Whether the data allow a clause of the program's own to be computed.
bool is_computed(const Clause& own, const Profile& profile, const Attempt& attempt) {
    if (own.decided_by == Computation::recorded_speeds)
        return profile.speed_source == SpeedSource::velocity;
    if (own.decided_by == Computation::speed_of)
        return !profile.speed_of && profile.speed_source == SpeedSource::position &&
               std::ranges::any_of(attempt.inputs, [](const AttemptInput& input) {
                   return input.name.starts_with("receivers.") &&
                          (input.name.find(".imu.") != std::string::npos ||
                           input.name.find(".antenna_motion.") != std::string::npos);
               });
    return own.decided_by != Computation::claims;
}

/// The rule's clauses, and those of the program's own that the data allow and the rule lacks.
std::vector<const Clause*> clauses_without_claims(const Profile& profile, const Attempt& attempt) {
    std::vector<const Clause*> clauses;
    for (const Clause& of_rule : profile.clauses)
        clauses.push_back(&of_rule);
    for (const Clause& own : own_clauses())
        if (is_computed(own, profile, attempt) && !asks(profile.clauses, own.decided_by))
            clauses.push_back(&own);
    return clauses;
}

/// Whether a rule considers the input: it neither belongs to another rule nor is replaced by one of
/// this rule's own.
bool concerns(const AttemptInput& input, const Profile& profile, const Attempt& attempt) {
    const bool replaced = input.name.starts_with("record.") && attempt.records.contains(profile.id);
    return !replaced && (input.profile.empty() || input.profile == profile.id);
}

/// In which clauses (ids) an official answers for an input that the rule looks at.
std::vector<std::string> clauses_answering(const AttemptInput& input, const Profile& profile,
                                           const Attempt& attempt) {
    std::vector<std::string> ids;
    if (!concerns(input, profile, attempt)) return ids;
    for (const Clause* const clause : clauses_without_claims(profile, attempt))
        if (std::ranges::count(input.origin.decides, to_text(clause->decided_by)) > 0)
            ids.push_back(clause->id);
    if (ids.empty() && !input.origin.clause.empty()) ids.push_back(input.origin.clause);
    return ids;
}

Finding computed(const Clause& clause, const ClauseContext& context) {
    switch (clause.decided_by) {
#define RUNCERT_CASE(word)  \
    case Computation::word: \
        return computation::word(clause, context);
        RUNCERT_EACH_COMPUTATION(RUNCERT_CASE)
#undef RUNCERT_CASE
    }
    throw Failure("clause " + clause.id, "its computation is none of this program's",
                  "This is a fault of the program; please report it");
}

}  // namespace

Requirement decide_clause(const Clause& clause, const ClauseContext& context) {
    Finding finding = computed(clause, context);
    if (!context.files_attested && context.course.ground &&
        finding.status != RequirementStatus::not_met) {
        ClauseContext without_surface = context;
        without_surface.course.ground.reset();
        finding = computed(clause, without_surface);
    }
    // What needs an answer before it can be computed is not failed.
    if (finding.status == RequirementStatus::not_met && !context.files_attested &&
        !context.windows.best &&
        windows_of(context.input.judged.windows, context.profile, true).best)
        finding.status = RequirementStatus::attest;
    const std::vector<AttemptInput> stated = inputs_answered_in(clause, context);
    if (finding.status == RequirementStatus::met && !finding.observed && !stated.empty()) {
        finding.status = RequirementStatus::attest;
        finding.evidence += "; it rests on what nobody observed: " + stated_text(stated);
    }
    // What the program asks itself is no text that has editions.
    const bool of_program = clause.source == own_source;
    std::optional<AnsweredBy> answered_by;
    if (finding.status == RequirementStatus::attest)
        answered_by = {.role = clause.answered_by.role, .count = clause.answered_by.count};
    return {.clause = clause.id,
            .status = finding.status,
            .evidence = finding.evidence,
            .text = clause.text,
            .source = clause.source,
            .edition = of_program ? "" : clause.edition,
            .where = of_program ? "" : clause.where,
            .looked_at = of_program                 ? ""
                         : clause.looked_at.empty() ? context.profile.looked_at
                                                    : clause.looked_at,
            .certainty = clause.certainty,
            .decided_by = clause.decided_by,
            .figures = std::move(finding.figures),
            .answered_by = std::move(answered_by)};
}

double in_unit(double value, const std::string& unit) {
    if (unit == "%") return 100.0 * value;
    const auto& speeds = speed_units();
    const bool of_speed = std::ranges::find(speeds, unit, &SpeedUnit::name) != speeds.end();
    return of_speed ? value / metres_per_second(unit) : value;
}

Finding against_limit(const Quantity& quantity, const Clause& clause) {
    const bool at_most = limit_of(clause.decided_by).at_most;
    Figure figure{.name = quantity.name,
                  .value = in_unit(quantity.value, clause.unit),
                  .unit = clause.unit,
                  .relation = at_most ? LimitRelation::at_most : LimitRelation::at_least,
                  .limit = clause.limit.value(),
                  .note = quantity.note};
    if (quantity.expanded_uncertainty)
        figure.expanded_uncertainty = in_unit(*quantity.expanded_uncertainty, clause.unit);
    const double reach = figure.expanded_uncertainty.value_or(0.0);
    const double sign = at_most ? 1.0 : -1.0;
    const bool can_meet = !(sign * figure.value - reach > sign * *figure.limit);
    const bool meets = sign * figure.value + reach <= sign * *figure.limit;
    const std::string evidence = fmt::format(
        "{} {}{}{}{}{}", figure.name,
        quantity_text(figure.value, figure.expanded_uncertainty, figure.unit), limit_text(figure),
        can_meet && !meets
            ? ": the limit lies within the uncertainty, not decidable from the recording"
            : "",
        figure.note.empty() ? "" : "; ", figure.note);
    Finding finding = meets      ? met("{}", evidence)
                      : can_meet ? to_attest("{}", evidence)
                                 : not_met("{}", evidence);
    if (const auto& also = meets ? quantity.if_met : quantity.if_not_met;
        also && (meets || !can_meet)) {
        finding.status = also->status;
        finding.evidence += also->evidence;
    }
    return std::move(finding).by({std::move(figure)});
}

std::vector<Clause> clauses_asked(const Profile& profile, const Attempt& attempt) {
    std::vector<std::string> answering;
    for (const AttemptInput& input : attempt.inputs)
        for (std::string& id : clauses_answering(input, profile, attempt))
            answering.push_back(std::move(id));
    std::vector<Clause> clauses;
    for (const Clause* const clause : clauses_without_claims(profile, attempt))
        clauses.push_back(*clause);
    for (const Clause& own : own_clauses())
        if (own.decided_by == Computation::claims && std::ranges::count(answering, own.id) > 0)
            clauses.push_back(own);
    return clauses;
}

std::vector<AttemptInput> inputs_answered_in(const Clause& clause, const ClauseContext& context) {
    std::vector<AttemptInput> inputs;
    const Attempt& attempt = context.input.attempt;
    for (const AttemptInput& input : attempt.inputs)
        if (input.origin.origin != to_text(InputOrigin::observed) &&
            std::ranges::count(clauses_answering(input, context.profile, attempt), clause.id) > 0)
            inputs.push_back(input);
    return inputs;
}

std::string stated_text(const std::vector<AttemptInput>& inputs) {
    std::vector<std::string> stated;
    for (const AttemptInput& input : inputs)
        stated.push_back(fmt::format(
            "{}: {}{}", input.name, claimed_value(input.value),
            input.origin.origin == to_text(InputOrigin::handed_in) ? " (handed in)" : ""));
    return fmt::format("{}", fmt::join(stated, "; "));
}

std::vector<VerdictInput> verdict_inputs(const CheckInput& input) {
    std::vector<VerdictInput> inputs;
    for (const AttemptInput& one : input.attempt.inputs) {
        VerdictInput& made =
            inputs.emplace_back(VerdictInput{.name = one.name, .value = one.value});
        from_text(one.origin.origin, made.origin);
        for (const Profile& profile : input.profiles)
            for (std::string& id : clauses_answering(one, profile, input.attempt))
                if (std::ranges::count(made.clauses, id) == 0)
                    made.clauses.push_back(std::move(id));
    }
    return inputs;
}

}  // namespace runcert
