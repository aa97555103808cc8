#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/statistics.h"
#include "reports/certificate/json_course.h"
#include "reports/certificate/json_facts.h"
#include "reports/certificate/json_parts.h"
#include "reports/certificate/json_rule.h"
#include "reports/certificate/json_window.h"
#include "reports/words/outcome.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// The figures of the decision as they are to be read.
Json headline_json(const ProfileVerdict& verdict, const ShownFigures& shown) {
    Json json{{"headline_speed", shown.speed},
              {"headline_unit", shown.unit},
              {"headline_uncertainty", shown.expanded_uncertainty},
              {"headline_coverage", coverage_text(verdict.coverage_factor)},
              {"headline_note", "Speed rounded down, uncertainty rounded up."}};
    if (shown.required_speed.empty()) return json;
    json["headline_required_speed"] = shown.required_speed;
    if (!shown.acceptance_limit.empty()) json["headline_acceptance_limit"] = shown.acceptance_limit;
    json["headline_note"] =
        "Speed rounded down; uncertainty, required speed and acceptance limit rounded up.";
    return json;
}

void set_results(Json& json, const ProfileVerdict& verdict, const Profile& profile) {
    const auto& uncertainty = verdict.expanded_uncertainty_m_s;
    std::optional<double> standard, lower, acceptance;
    if (uncertainty) standard = *uncertainty / verdict.coverage_factor;
    if (verdict.speed_m_s && uncertainty) lower = *verdict.speed_m_s - *uncertainty;
    if (verdict.decision) acceptance = verdict.decision->acceptance_limit_m_s;
    set_speeds(json, "speed", verdict.speed_m_s);
    set_speeds(json, "standard_uncertainty", standard);
    set_speeds(json, "expanded_uncertainty", uncertainty);
    set_speeds(json, "lower_limit", lower);
    set_speeds(json, "required_speed", verdict.required_speed_m_s);
    json["speed_table"] = speed_table(
        {{"Measured speed", verdict.speed_m_s},
         {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
          uncertainty, SpeedRow::uncertainty},
         {"Measured speed less expanded uncertainty", lower},
         {"Acceptance limit", acceptance, SpeedRow::limit},
         {"Required speed", verdict.required_speed_m_s, SpeedRow::limit},
         {"Standing record",
          verdict.record ? std::optional(verdict.record->speed_m_s) : std::nullopt,
          SpeedRow::stated}},
        profile, uncertainty);
    if (verdict.speed_m_s)
        json["headline"] = headline_json(verdict, shown_of(verdict, rule_unit(profile).name));
}

Json requirement_json(const Requirement& requirement) {
    Json json = members_json(requirement);
    json["status_words"] = words_of(requirement.status);
    json["certainty_words"] = words_of(requirement.certainty);
    json["figures"] = quantities_json(requirement.figures);
    return json;
}

/// The same rule by each receiver, where there are two.
Json by_receiver_json(const ReportInputs& inputs, const Profile& profile) {
    Json list = Json::array();
    if (inputs.receivers.size() < 2) return list;
    for (const ReceiverResults& results : inputs.receivers) {
        Json entry{{"receiver", results.windows.receiver}};
        const ProfileWindows* windows = windows_of(results.windows, profile.id);
        if (const auto figure = windows == nullptr ? std::nullopt : figure_of(*windows)) {
            const double u = expanded_uncertainty_by_rule_m_s(*figure, profile.coverage_factor);
            const SpeedUnit& unit = rule_unit(profile);
            set_speeds(entry, "speed", figure->speed_m_s);
            set_speeds(entry, "expanded_uncertainty", u);
            entry["by_receiver_words"] =
                fmt::format("{}, {} after its first epoch",
                            speed_with_uncertainty_text(figure->speed_m_s, u, unit),
                            seconds_text(windows->best->span.start));
        } else {
            entry["by_receiver_words"] = "no certifiable window";
        }
        list.push_back(std::move(entry));
    }
    return list;
}

/// "11 requirements in all: 6 met, 0 not met, 5 to be attested (listed below)."
std::string requirement_counts(const ProfileVerdict& verdict) {
    const auto count = [&](RequirementStatus status) {
        return std::ranges::count(verdict.requirements, status, &Requirement::status);
    };
    return fmt::format("{} in all: {} met, {} not met, {} to be attested (listed below).",
                       counted(std::ssize(verdict.requirements), "requirement"),
                       count(RequirementStatus::met), count(RequirementStatus::not_met),
                       count(RequirementStatus::attest));
}

}  // namespace

Json profile_json(const ReportInputs& inputs, std::size_t index) {
    const ProfileVerdict& verdict = inputs.verdict.profiles[index];
    const Profile& profile = inputs.profiles[index];
    const OutcomeWords words = outcome_words(state_of(verdict));
    Json json{{"profile", verdict.profile},
              {"body", verdict.body},
              {"title", verdict.title},
              {"rule_identity", members_json(verdict.rule)},
              {"rule_identity_words", rule_identity_text(verdict)},
              {"outcome", to_text(verdict.outcome)},
              {"outcome_title", words.title},
              {"outcome_mark", words.mark},
              {"tone", words.tone},
              {"standing", members_json(verdict.standing)},
              {"standing_words", standing_text(verdict.standing)},
              {"reason", verdict.reason},
              {"definition", to_text(verdict.definition)},
              {"coverage_factor", verdict.coverage_factor},
              {"qualification", requirement_counts(verdict)}};
    json["rule_words"] = rule_words(profile);
    set_rule(json, profile);
    set_decision(json, verdict, profile);
    set_reservations(json, verdict);
    set_results(json, verdict, profile);
    const ProfileWindows* windows = windows_of(inputs.receivers.front().windows, verdict.profile);
    if (windows != nullptr && !windows->missing.empty())
        json["missing_words"] = fmt::format("What is missing: {}.", windows->missing);
    if (verdict.window) json["window"] = window_json(verdict, windows, profile);
    set_course(json, verdict, profile);
    if (verdict.indicated) json["indicated"] = indicated_json(verdict, profile);
    json["by_receiver"] = by_receiver_json(inputs, profile);
    json["requirements"] = Json::array();
    for (const Requirement& requirement : verdict.requirements)
        json["requirements"].push_back(requirement_json(requirement));
    return json;
}

}  // namespace runcert
