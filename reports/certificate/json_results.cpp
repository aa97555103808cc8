#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/statistics.h"
#include "reports/certificate/display.h"
#include "reports/certificate/json_course.h"
#include "reports/certificate/json_parts.h"
#include "reports/certificate/json_rule.h"
#include "reports/certificate/json_window.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

struct OutcomeWords {
    std::string title;
    std::string mark;
    std::string tone;  ///< how the page colours it
};

OutcomeWords outcome_words(const ProfileVerdict& verdict) {
    const std::string title(phrase_of(verdict.outcome));
    switch (verdict.outcome) {
        case Outcome::beaten:
            return {title, "✓", "yes"};
        case Outcome::not_beaten:
            return {title, "✗", "no"};
        case Outcome::not_certifiable:
            return {title, "✗", "refused"};
        case Outcome::not_proven:
            break;
    }
    return {verdict.required_speed_m_s ? title : "Speed measured; no record is named", "–", "open"};
}

/// The speed as it is to be read.
Json headline_json(const ProfileVerdict& verdict, const Profile& profile) {
    if (const auto& shown = verdict.shown) {
        Json json{{"headline_speed", shown->speed},
                  {"headline_unit", shown->unit},
                  {"headline_uncertainty", shown->expanded_uncertainty},
                  {"headline_note", "Speed rounded down, uncertainty rounded up."}};
        if (!shown->required_speed.empty()) {
            json["headline_required_speed"] = shown->required_speed;
            json["headline_note"] =
                "Speed rounded down, uncertainty and required speed rounded up.";
        }
        return json;
    }
    const SpeedUnit& unit = rule_unit(profile);
    const auto& uncertainty = verdict.expanded_uncertainty_m_s;
    Json json{{"headline_speed", speed_text(*verdict.speed_m_s, uncertainty, unit)},
              {"headline_unit", unit.name}};
    if (uncertainty) json["headline_uncertainty"] = uncertainty_text(*uncertainty * unit.per_m_s);
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
        {{"Speed", verdict.speed_m_s},
         {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
          uncertainty, SpeedRow::uncertainty},
         {"Speed less expanded uncertainty", lower},
         {"Least speed that would be accepted", acceptance},
         {"Required speed", verdict.required_speed_m_s},
         {"Standing record",
          verdict.record ? std::optional(verdict.record->speed_m_s) : std::nullopt,
          SpeedRow::stated}},
        profile, uncertainty);
    if (verdict.speed_m_s) json["headline"] = headline_json(verdict, profile);
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

std::string qualification(const ProfileVerdict& verdict) {
    const auto count = std::count_if(
        verdict.requirements.begin(), verdict.requirements.end(),
        [](const Requirement& entry) { return entry.status == RequirementStatus::attest; });
    return count == 0 ? ""
                      : fmt::format("{} of {} still to be attested (listed below).",
                                    counted(count, "requirement"), verdict.requirements.size());
}

}  // namespace

Json profile_json(const ReportInputs& inputs, std::size_t index) {
    const ProfileVerdict& verdict = inputs.verdict.profiles[index];
    const Profile& profile = inputs.profiles[index];
    const OutcomeWords words = outcome_words(verdict);
    Json json{{"profile", verdict.profile},
              {"body", verdict.body},
              {"title", verdict.title},
              {"outcome", to_text(verdict.outcome)},
              {"outcome_title", words.title},
              {"outcome_mark", words.mark},
              {"tone", words.tone},
              {"reason", verdict.reason},
              {"definition", to_text(verdict.definition)},
              {"coverage_factor", verdict.coverage_factor}};
    if (const std::string words_left = qualification(verdict); !words_left.empty())
        json["qualification"] = words_left;
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
    if (verdict.indicated) json["indicated"] = indicated_json(*verdict.indicated, profile);
    json["by_receiver"] = by_receiver_json(inputs, profile);
    json["requirements"] = Json::array();
    for (const Requirement& requirement : verdict.requirements)
        json["requirements"].push_back(requirement_json(requirement));
    return json;
}

}  // namespace runcert
