#include "schemas/verdict/outcome.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/claimed_text.h"
#include "core/prose.h"
#include "core/rounding.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

/// Answers that do not count.
std::vector<std::string> answered_otherwise(const Standing& standing) {
    std::vector<std::string> words;
    if (const std::int64_t count = standing.unvouched.value_or(0); count > 0)
        words.push_back(
            fmt::format("{} by keys that nobody vouched for", counted(count, "answer")));
    if (const std::int64_t count = standing.refused.value_or(0); count > 0)
        words.push_back(fmt::format("{} answered no", counted(count, "requirement")));
    if (standing.unclosed.value_or(0) > 0) words.emplace_back("answers not closed");
    if (!standing.other_record.empty())
        words.push_back("another record stands by the roster, " + standing.other_record);
    return words;
}

/// "; 5 requirements still to be attested and 1 signature required"; empty where nothing is open.
std::string due_text(const Standing& standing) {
    std::vector<std::string> open;
    if (standing.attestations > 0)
        open.push_back(
            fmt::format("{} still to be attested", counted(standing.attestations, "requirement")));
    if (standing.signatures > 0)
        open.push_back(fmt::format("{} required", counted(standing.signatures, "signature")));
    for (std::string& more : answered_otherwise(standing))
        open.push_back(std::move(more));
    return (open.empty() ? "" : "; ") + listed(open);
}

std::string beaten_title(const OutcomeState& state) {
    if (state.standing.state == StandingState::complete && !state.vouched_by.empty() &&
        !state.rule_altered)
        return "Record beaten, " + state.vouched_by;
    return "Measured speed exceeds the record" + altered_text(state) + due_text(state.standing);
}

/// Inputs of one part of the attempt that are answered for in the same clauses.
struct Group {
    std::string part;  ///< "course", "receivers.primary"
    std::vector<std::string> clauses;
    std::vector<const VerdictInput*> inputs;
};

/// Without its last key.
std::string part_of(const std::string& name) {
    const std::size_t point = name.rfind('.');
    return point == std::string::npos ? name : name.substr(0, point);
}

/// Whether two parts are the same, or one is within the other.
bool is_within(const std::string& part, const std::string& other) {
    return part == other || part.starts_with(other + ".") || other.starts_with(part + ".");
}

std::vector<Group> groups_of(const std::vector<VerdictInput>& inputs, InputOrigin origin) {
    std::vector<Group> groups;
    for (const VerdictInput& input : inputs) {
        if (input.origin != origin) continue;
        const std::string part = part_of(input.name);
        if (!groups.empty() && groups.back().clauses == input.clauses &&
            is_within(part, groups.back().part)) {
            if (part.size() < groups.back().part.size()) groups.back().part = part;
            groups.back().inputs.push_back(&input);
        } else {
            groups.push_back({.part = part, .clauses = input.clauses, .inputs = {&input}});
        }
    }
    return groups;
}

std::string group_text(const Group& group) {
    constexpr std::size_t each_by_itself = 3;
    std::vector<std::string> said;
    if (group.inputs.size() > each_by_itself)
        said.push_back(
            fmt::format("{} ({})", group.part, counted(std::ssize(group.inputs), "figure")));
    else
        for (const VerdictInput* const one : group.inputs)
            said.push_back(fmt::format("{}: {}", one->name, claimed_value(one->value)));
    return fmt::format("{}{}", fmt::join(said, ", "),
                       group.clauses.empty()
                           ? std::string(" (no rule looks at it)")
                           : fmt::format(" [{}]", fmt::join(group.clauses, ", ")));
}

}  // namespace

Standing standing_of(const std::vector<Requirement>& requirements, std::int64_t signatures) {
    Standing standing{.attestations = std::ranges::count(requirements, RequirementStatus::attest,
                                                         &Requirement::status),
                      .signatures = signatures};
    if (standing.attestations == 0 && standing.signatures == 0)
        standing.state = StandingState::complete;
    return standing;
}

const Figure* slower_craft(const ProfileVerdict& verdict) {
    if (verdict.outcome != Outcome::beaten) return nullptr;
    const auto asked =
        std::ranges::find(verdict.requirements, Computation::speed_of, &Requirement::decided_by);
    if (asked == verdict.requirements.end()) return nullptr;
    for (const Figure& figure : asked->figures)
        if (figure.relation == LimitRelation::at_least && figure.limit &&
            figure.value + figure.expanded_uncertainty.value_or(0.0) < *figure.limit)
            return &figure;
    return nullptr;
}

OutcomeState state_of(const ProfileVerdict& verdict) {
    return {
        .outcome = verdict.outcome,
        .standing = verdict.standing,
        .record_named = verdict.record.has_value(),
        .craft_too_slow = slower_craft(verdict) != nullptr,
        .rule_altered = !verdict.overrides.empty() || verdict.rule.origin != RuleOrigin::built_in};
}

std::string altered_text(const OutcomeState& state) {
    return state.rule_altered ? " under altered rules" : "";
}

OutcomeWords outcome_words(const OutcomeState& state) {
    switch (state.outcome) {
        case Outcome::beaten:
            if (state.craft_too_slow && state.standing.state != StandingState::complete)
                return {"The craft was too slow" + altered_text(state) +
                            "; its antenna exceeds the record" + due_text(state.standing),
                        "?", "open"};
            return {beaten_title(state), "✓", "yes"};
        case Outcome::not_beaten:
            return {"Record not beaten" + altered_text(state) +
                        ": measured speed below the required speed",
                    "✗", "no"};
        case Outcome::not_proven:
            return state.record_named ? OutcomeWords{"Not proven" + altered_text(state) +
                                                         ": required speed within the uncertainty",
                                                     "?", "open"}
                                      : OutcomeWords{"Speed measured" + altered_text(state) +
                                                         "; the attempt names no record",
                                                     "–", "open"};
        case Outcome::not_certifiable:
            break;
    }
    return {"Not certifiable" + altered_text(state), "⊘", "refused"};
}

std::string source_text(const Requirement& requirement) {
    std::string text = requirement.source;
    if (!requirement.edition.empty()) text += ", edition " + requirement.edition;
    if (!requirement.where.empty()) text += ", " + requirement.where;
    if (!requirement.looked_at.empty()) text += "; looked at " + requirement.looked_at;
    return text;
}

std::string rule_identity_text(const ProfileVerdict& verdict) {
    if (verdict.rule.origin == RuleOrigin::built_in)
        return fmt::format("rule “{}”, revision {}", verdict.profile, verdict.rule.revision);
    return fmt::format("the attempt's own rule “{}”, revision {}", verdict.profile,
                       verdict.rule.revision);
}

std::string positions_alone_text(const ProfileVerdict& verdict) {
    const SpeedUnit& unit = speed_unit(verdict.shown ? verdict.shown->unit : "km/h");
    return fmt::format(
        "The result rests on positions alone: a drift below {} {} could not have been seen.",
        uncertainty_rounded_up(*verdict.unseen_drift_m_s * unit.per_m_s), unit.name);
}

std::string standing_text(const Standing& standing) {
    if (standing.state == StandingState::complete) return "complete";
    std::vector<std::string> open;
    if (standing.attestations > 0) open.push_back(counted(standing.attestations, "attestation"));
    if (standing.signatures > 0) open.push_back(counted(standing.signatures, "signature"));
    std::vector<std::string> words = answered_otherwise(standing);
    if (!open.empty()) words.insert(words.begin(), "awaiting " + listed(open));
    return fmt::format("{}", fmt::join(words, "; "));
}

std::vector<InputsOfOrigin> inputs_by_origin(const std::vector<VerdictInput>& inputs) {
    constexpr std::array<std::pair<InputOrigin, std::string_view>, 3> labels{
        {{InputOrigin::observed, "Observed"},
         {InputOrigin::handed_in, "Handed in"},
         {InputOrigin::claimed, "Claimed"}}};
    std::vector<InputsOfOrigin> said;
    for (const auto& [origin, label] : labels) {
        std::vector<std::string> texts;
        for (const Group& group : groups_of(inputs, origin))
            texts.push_back(group_text(group));
        if (!texts.empty())
            said.push_back({std::string(label), fmt::format("{}", fmt::join(texts, "; "))});
    }
    return said;
}

}  // namespace runcert
