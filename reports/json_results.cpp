#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "files/yaml_output.h"
#include "reports/display.h"
#include "reports/json_parts.h"

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

/// The unit in which the rule is written: the one it rounds in, or limits accuracy in.
const SpeedUnit& rule_unit(const Profile& profile) {
    return speed_unit(profile.rounding ? profile.rounding->unit : profile.accuracy_unit);
}

/// km/h, m/s, kn, mph, the rule's own in front.
std::vector<const SpeedUnit*> units_in_order(const Profile& profile) {
    std::vector<const SpeedUnit*> units{&rule_unit(profile)};
    for (const SpeedUnit& unit : speed_units())
        if (&unit != units.front()) units.push_back(&unit);
    return units;
}

const ProfileWindows* windows_of(const Windows& windows, const std::string& profile) {
    const auto found =
        std::find_if(windows.profiles.begin(), windows.profiles.end(),
                     [&](const ProfileWindows& entry) { return entry.profile == profile; });
    return found == windows.profiles.end() ? nullptr : &*found;
}

Json span_json(const WindowSpan& span) {
    Json json = window_span_json(span);
    if (span.start_gps) {
        const GpsTime end = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
        json["end_gps"] = to_iso(end, 3);
        json["end_utc"] = to_utc_iso(end, 3);
    }
    return json;
}

Json span_facts(const WindowSpan& span) {
    Json facts = Json::array();
    if (span.start_gps) {
        const GpsTime end = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
        facts.push_back(
            fact("UTC", fmt::format("{} to {}", utc_text(*span.start_gps), utc_text(end))));
        facts.push_back(
            fact("GPS time", fmt::format("{} to {}", gps_text(*span.start_gps), gps_text(end))));
    } else {
        facts.push_back(fact("UTC", "not known: the recording's time is relative"));
    }
    const ElapsedTime end{span.start.nanoseconds + span.duration.nanoseconds};
    facts.push_back(fact("From the first epoch", fmt::format("{} to {}", seconds_text(span.start),
                                                             seconds_text(end))));
    facts.push_back(fact("Length", seconds_text(span.duration)));
    facts.push_back(
        fact("Epochs", fmt::format("{} to {}", span.first_epoch, span.last_epoch)));
    return facts;
}

struct SpeedRow {
    std::string label;
    std::optional<double> speed_mps;
    bool is_uncertainty = false;
};

/// Rows of one speed each, in every unit.
Json speed_table(const std::vector<SpeedRow>& rows, const Profile& profile,
                 std::optional<double> uncertainty_mps) {
    Json table{{"units", Json::array()}, {"rows", Json::array()}};
    const auto units = units_in_order(profile);
    for (const SpeedUnit* unit : units) table["units"].push_back(unit->name);
    for (const SpeedRow& row : rows) {
        if (!row.speed_mps) continue;
        Json entry{{"label", row.label}, {"cells", Json::array()}};
        for (const SpeedUnit* unit : units)
            entry["cells"].push_back(row.is_uncertainty
                                         ? uncertainty_text(*row.speed_mps * unit->per_mps)
                                         : speed_text(*row.speed_mps, uncertainty_mps, *unit));
        table["rows"].push_back(std::move(entry));
    }
    return table;
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
    const std::string k = Json(verdict.coverage_factor).dump();
    json["speed_table"] = speed_table(
        {{"Speed", verdict.speed_mps},
         {fmt::format("Expanded uncertainty (k = {})", k), uncertainty, true},
         {"Standard uncertainty", standard, true},
         {"Speed less expanded uncertainty", lower},
         {"Speed to reach", verdict.target_mps},
         {"Standing record", record}},
        profile, uncertainty);
    if (!verdict.speed_mps) return;
    const SpeedUnit& unit = rule_unit(profile);
    json["headline"] = {{"headline_speed", speed_text(*verdict.speed_mps, uncertainty, unit)},
                        {"headline_unit", unit.name}};
    if (uncertainty)
        json["headline"]["headline_uncertainty"] = uncertainty_text(*uncertainty * unit.per_mps);
}

void set_definitions(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const SpeedDefinitions& all = best.definitions;
    const double u = best.standard_uncertainty_mps * profile.coverage_factor;
    std::vector<SpeedRow> rows;
    json["definitions"] = Json::array();
    for (const std::string_view name : {"displacement", "path_length", "mean_n_plus_1", "mean_n"}) {
        const bool counts = name == profile.definition;
        Json entry{{"definition", name}, {"counts", counts}};
        set_speeds(entry, "speed", all.by_name(name));
        json["definitions"].push_back(std::move(entry));
        rows.push_back({definition_words(name) + (counts ? " – the rule's" : ""),
                        all.by_name(name)});
    }
    json["definition_table"] = speed_table(rows, profile, u);
}

void set_methods(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const std::vector<std::pair<std::string, SpeedRow>> methods{
        {"smoothed", {"Smoother, forward and backward", best.methods.smoothed_mps}},
        {"batch", {"Batch least squares", best.methods.batch_mps}},
        {"v1", {"Method v1 of [DHD22]: central difference", best.methods.v1_mps}},
        {"v2", {"Method v2 of [DHD22]: path length", best.methods.v2_mps}},
        {"kalman", {"Forward filter of [DHD22]", best.methods.kalman_mps}}};
    json["methods"] = Json::array();
    std::vector<SpeedRow> rows;
    for (const auto& [name, row] : methods) {
        rows.push_back(row);
        if (!row.speed_mps) continue;
        Json entry{{"method", name}};
        set_speeds(entry, "speed", row.speed_mps);
        json["methods"].push_back(std::move(entry));
    }
    json["method_table"] =
        speed_table(rows, profile, best.standard_uncertainty_mps * profile.coverage_factor);
}

Json window_json(const ProfileVerdict& verdict, const ProfileWindows* windows,
                 const Profile& profile) {
    Json json = span_json(*verdict.window);
    Json facts = span_facts(*verdict.window);
    if (windows != nullptr && windows->best) {
        const CertifiableWindow& best = *windows->best;
        json["arc"] = best.arc;
        json["candidates"] = windows->candidates;
        json["displacement_m"] = rounded(best.displacement_m, 6);
        facts.push_back(
            fact("Distance between its ends", format_fixed(best.displacement_m, 3) + " m"));
        facts.push_back(fact("Windows compared", Json(windows->candidates).dump()));
        set_definitions(json, best, profile);
        set_methods(json, best, profile);
    }
    json["window_facts"] = std::move(facts);
    return json;
}

Json indicated_json(const RefusedWindow& indicated, const Profile& profile) {
    Json json = span_json(indicated.span);
    set_speeds(json, "speed", indicated.speed_mps);
    const SpeedUnit& unit = rule_unit(profile);
    json["indicated_speed"] = fmt::format(
        "{} {}", speed_text(indicated.speed_mps, std::nullopt, unit), unit.name);
    json["refusals"] = indicated.refusals;
    json["indicated_facts"] = span_facts(indicated.span);
    return json;
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
            const double u = best.standard_uncertainty_mps * profile.coverage_factor;
            const SpeedUnit& unit = rule_unit(profile);
            set_speeds(entry, "speed", best.speed_mps);
            set_speeds(entry, "expanded_uncertainty", u);
            entry["by_receiver_words"] =
                fmt::format("{} ± {} {}, {} after its first epoch",
                            speed_text(best.speed_mps, u, unit),
                            uncertainty_text(u * unit.per_mps), unit.name,
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

std::string definition_words(std::string_view definition) {
    if (definition == "displacement") return "Displacement over time";
    if (definition == "path_length") return "Path length over time";
    if (definition == "mean_n_plus_1") return "Mean of the speeds, both ends included";
    return "Mean of the speeds after the first";
}

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
    json["rule_words"] =
        fmt::format("{} over {} s, {}.", "Speed averaged", Json(profile.duration_s).dump(),
                    "by: " + definition_words(verdict.definition));
    json["decision_rule"] = fmt::format(
        "The record counts as beaten where the speed less its expanded uncertainty (k = {}) "
        "reaches the speed to reach.",
        Json(verdict.coverage_factor).dump());
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
