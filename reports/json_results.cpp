#include <fmt/format.h>

#include <algorithm>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "reports/display.h"
#include "reports/json_parts.h"
#include "reports/json_window.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

struct OutcomeWords {
    std::string title;
    std::string mark;
    std::string tone;  ///< how the page colours it
};

OutcomeWords outcome_words(const ProfileVerdict& verdict) {
    if (verdict.outcome == "beaten") return {"Record beaten", "✓", "yes"};
    if (verdict.outcome == "not_beaten") return {"Record not beaten", "✗", "no"};
    if (verdict.outcome == "not_certifiable") return {"Not certifiable", "✗", "refused"};
    if (!verdict.target_mps) return {"Speed measured; no record is named", "–", "open"};
    return {"Not proven", "–", "open"};
}

std::string status_words(const std::string& status) {
    if (status == "met") return "met";
    return status == "not_met" ? "not met" : "to attest";
}

std::string certainty_words(const std::string& certainty) {
    if (certainty == "quoted") return "quoted from the rule";
    return certainty == "secondary" ? "as told by others" : "not confirmed";
}

const ProfileWindows* windows_of(const Windows& windows, const std::string& profile) {
    const auto found =
        std::find_if(windows.profiles.begin(), windows.profiles.end(),
                     [&](const ProfileWindows& entry) { return entry.profile == profile; });
    return found == windows.profiles.end() ? nullptr : &*found;
}

void set_results(Json& json, const ReportInputs& inputs, const ProfileVerdict& verdict,
                 const Profile& profile) {
    const auto& uncertainty = verdict.expanded_uncertainty_mps;
    std::optional<double> standard, lower, record;
    if (uncertainty) standard = *uncertainty / verdict.coverage_factor;
    if (verdict.speed_mps && uncertainty) lower = *verdict.speed_mps - *uncertainty;
    if (inputs.verdict.record) record = inputs.verdict.record->speed_mps;
    set_speeds(json, "speed", verdict.speed_mps);
    set_speeds(json, "standard_uncertainty", standard);
    set_speeds(json, "expanded_uncertainty", uncertainty);
    set_speeds(json, "lower_limit", lower);
    set_speeds(json, "target", verdict.target_mps);
    json["speed_table"] = speed_table(
        {{"Speed", verdict.speed_mps},
         {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
          uncertainty, SpeedRow::uncertainty},
         {"Speed less expanded uncertainty", lower},
         {"Speed to reach", verdict.target_mps},
         {"Standing record", record, SpeedRow::stated}},
        profile, uncertainty);
    if (!verdict.speed_mps) return;
    const SpeedUnit& unit = rule_unit(profile);
    json["headline"] = {{"headline_speed", speed_text(*verdict.speed_mps, uncertainty, unit)},
                        {"headline_unit", unit.name}};
    if (uncertainty)
        json["headline"]["headline_uncertainty"] = uncertainty_text(*uncertainty * unit.per_mps);
}

Json requirement_json(const Requirement& requirement) {
    return {{"clause", requirement.clause},
            {"status", requirement.status},
            {"status_words", status_words(requirement.status)},
            {"clause_text", requirement.text},
            {"evidence", requirement.evidence},
            {"source", requirement.source},
            {"certainty", requirement.certainty},
            {"certainty_words", certainty_words(requirement.certainty)}};
}

/// The same rule by each receiver, where there are two.
Json by_receiver_json(const ReportInputs& inputs, const Profile& profile) {
    Json list = Json::array();
    if (inputs.receivers.size() < 2) return list;
    for (const ReceiverResults& results : inputs.receivers) {
        Json entry{{"receiver", results.windows.receiver}};
        const ProfileWindows* windows = windows_of(results.windows, profile.id);
        if (windows != nullptr && windows->best) {
            const CertifiableWindow& best = *windows->best;
            const double u = best.standard_uncertainty_mps *
                             equivalent_coverage_factor(profile.coverage_factor,
                                                        best.effective_degrees_of_freedom);
            const SpeedUnit& unit = rule_unit(profile);
            set_speeds(entry, "speed", best.speed_mps);
            set_speeds(entry, "expanded_uncertainty", u);
            entry["by_receiver_words"] =
                fmt::format("{}, {} after its first epoch",
                            speed_with_uncertainty_text(best.speed_mps, u, unit),
                            seconds_text(best.span.start));
        } else {
            entry["by_receiver_words"] = "no certifiable window";
        }
        list.push_back(std::move(entry));
    }
    return list;
}

std::string qualification(const ProfileVerdict& verdict) {
    const auto count =
        std::count_if(verdict.requirements.begin(), verdict.requirements.end(),
                      [](const Requirement& entry) { return entry.status == "attest"; });
    return count == 0 ? ""
                      : fmt::format("{} of {} left for a person to attest: see below.",
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
              {"outcome", verdict.outcome},
              {"outcome_title", words.title},
              {"outcome_mark", words.mark},
              {"tone", words.tone},
              {"reason", verdict.reason},
              {"rule_duration_s", profile.duration_s},
              {"definition", verdict.definition},
              {"coverage_factor", verdict.coverage_factor}};
    if (const std::string words_left = qualification(verdict); !words_left.empty())
        json["qualification"] = words_left;
    json["rule_words"] = fmt::format("Speed over {} s, by the definition: {}.", profile.duration_s,
                                     definition_words(verdict.definition));
    json["decision_rule"] = fmt::format(
        "The record counts as beaten where the speed less its expanded uncertainty (k = {}) "
        "reaches the speed to reach.",
        coverage_text(verdict.coverage_factor));
    set_results(json, inputs, verdict, profile);
    if (verdict.window)
        json["window"] = window_json(
            verdict, windows_of(inputs.receivers.front().windows, verdict.profile), profile);
    if (verdict.indicated) json["indicated"] = indicated_json(*verdict.indicated, profile);
    json["by_receiver"] = by_receiver_json(inputs, profile);
    json["requirements"] = Json::array();
    for (const Requirement& requirement : verdict.requirements)
        json["requirements"].push_back(requirement_json(requirement));
    return json;
}

}  // namespace runcert
