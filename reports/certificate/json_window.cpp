#include "reports/certificate/json_window.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_reliability.h"
#include "reports/certificate/json_rule.h"
#include "reports/certificate/json_uncertainty.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// km/h, m/s, kn, mph, the rule's own in front.
std::vector<const SpeedUnit*> units_in_order(const Profile& profile) {
    std::vector<const SpeedUnit*> units{&rule_unit(profile)};
    for (const SpeedUnit& unit : speed_units())
        if (&unit != units.front()) units.push_back(&unit);
    return units;
}

/// When a window was, on the clock.
Json time_facts(const WindowSpan& span) {
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
    facts.push_back(fact("Length", seconds_text(span.duration)));
    return facts;
}

/// Where a window is in the recording.
Json place_facts(const WindowSpan& span) {
    Json facts = Json::array();
    const ElapsedTime end{span.start.nanoseconds + span.duration.nanoseconds};
    facts.push_back(fact("From the first epoch",
                         fmt::format("{} to {}", seconds_text(span.start), seconds_text(end))));
    facts.push_back(fact("Epochs", fmt::format("{} to {}", span.first_epoch, span.last_epoch)));
    return facts;
}

/// The rule's speed where it is none of the four definitions; empty where it is one.
std::string other_definition(const Profile& profile) {
    if (profile.window_kind == WindowKind::course) return "Over the course";
    if (profile.speed_source == SpeedSource::velocity)
        return fmt::format("Recorded velocities, {}", words_of(profile.definition));
    return {};
}

/// The decimals that the rule gives speeds in its own unit.
std::optional<int> rule_decimals(const Profile& profile, const SpeedUnit& unit) {
    const auto& rule = profile.result ? profile.result : profile.rounding;
    if (!rule || &unit != &rule_unit(profile)) return std::nullopt;
    return rule->decimals;
}

std::string speed_cell(const SpeedRow& row, const Profile& profile,
                       const std::optional<double>& uncertainty_m_s, const SpeedUnit& unit) {
    const double speed = *row.speed_m_s * unit.per_m_s;
    if (row.kind == SpeedRow::uncertainty) return uncertainty_rounded_up(speed);
    if (row.kind == SpeedRow::stated || !uncertainty_m_s)
        return speed_text(*row.speed_m_s, std::nullopt, unit);
    return shown_figure(speed,
                        decimals_of(*uncertainty_m_s * unit.per_m_s, rule_decimals(profile, unit)),
                        row.kind == SpeedRow::limit ? SafeSide::up : SafeSide::down);
}

/// To which speeds beside the measured one are rounded.
double shown_uncertainty(const CertifiableWindow& window, const Profile& profile) {
    return expanded_uncertainty_m_s(window, profile.coverage_factor);
}

std::string definition_note(const CertifiableWindow& best, const Profile& profile) {
    if (profile.window_kind == WindowKind::course)
        return "None of the four definitions is the rule's: its speed is over the course, the "
               "surveyed length over the time between the lines. They are of the smoothed "
               "trajectory.";
    if (profile.speed_source == SpeedSource::velocity)
        return "None of the four definitions is the rule's: its speed is of the velocities that "
               "the recording states. They are of the smoothed trajectory.";
    if (best.estimates && best.selection &&
        best.selection->treatment == SelectionTreatment::subtracted)
        return "These figures are of the smoothed trajectory. The measured speed is the rule's, "
               "less what choosing the fastest window makes it look higher by.";
    return {};
}

void set_definitions(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const SpeedDefinitions& all = best.definitions;
    const double u = shown_uncertainty(best, profile);
    std::vector<SpeedRow> rows;
    json["definitions"] = Json::array();
    const std::string other = other_definition(profile);
    if (!other.empty()) rows.push_back({other + " – the rule's", best.speed_m_s});
    for (const SpeedDefinition name : {SpeedDefinition::displacement, SpeedDefinition::path_length,
                                       SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
        const bool counts = other.empty() && name == profile.definition;
        Json entry{{"definition", to_text(name)}, {"counts", counts}};
        set_speeds(entry, "speed", speed_by(all, name));
        json["definitions"].push_back(std::move(entry));
        rows.push_back(
            {definition_words(name) + (counts ? " – the rule's" : ""), speed_by(all, name)});
    }
    const std::string note = definition_note(best, profile);
    if (!note.empty()) json["definition_note"] = note;
    if (!best.fitted)
        rows.push_back(
            {"Standard uncertainty", best.standard_uncertainty_m_s, SpeedRow::uncertainty});
    json["definition_table"] = speed_table(rows, profile, u);
}

std::string window_label(const WindowSpan& span) {
    return fmt::format("{} from {}", seconds_text(span.duration), seconds_text(span.start));
}

/// The windows that make the figure together with the best one.
void set_further(Json& json, const ProfileWindows& windows, const Profile& profile) {
    if (windows.further.empty()) return;
    const double u = shown_uncertainty(*windows.best, profile);
    std::vector<SpeedRow> rows{{window_label(windows.best->span), windows.best->speed_m_s}};
    for (const FurtherWindow& further : windows.further) {
        Json entry = members_json(further.span);
        set_end(entry, further.span);
        entry["arc"] = further.arc;
        set_speeds(entry, "speed", further.speed_m_s);
        set_speeds(entry, "standard_uncertainty", further.standard_uncertainty_m_s);
        json["further"].push_back(std::move(entry));
        rows.push_back({window_label(further.span), further.speed_m_s});
    }
    if (const auto figure = figure_of(windows))
        rows.push_back({fmt::format("Mean of the {}", rows.size()), figure->speed_m_s});
    json["further_table"] = speed_table(rows, profile, u);
}

void set_methods(Json& json, const CertifiableWindow& best, const Profile& profile) {
    const std::vector<std::pair<std::string, SpeedRow>> methods{
        {"smoothed", {"Smoother, forward and backward", best.methods.smoothed_m_s}},
        {"batch", {"Batch least squares", best.methods.batch_m_s}},
        {"v1", {"Method v1 of [DHD22]: central difference", best.methods.v1_m_s}},
        {"v2", {"Method v2 of [DHD22]: path length", best.methods.v2_m_s}},
        {"kalman", {"Forward filter of [DHD22]", best.methods.kalman_m_s}}};
    json["methods"] = Json::array();
    std::vector<SpeedRow> rows;
    for (const auto& [name, row] : methods) {
        rows.push_back(row);
        if (!row.speed_m_s) continue;
        Json entry{{"method", name}};
        set_speeds(entry, "speed", row.speed_m_s);
        json["methods"].push_back(std::move(entry));
    }
    json["method_table"] = speed_table(rows, profile, shown_uncertainty(best, profile));
}

}  // namespace

void set_end(Json& json, const WindowSpan& span) {
    if (!span.start_gps) return;
    const GpsTime end = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
    json["end_gps"] = to_iso(end, 3);
    json["end_utc"] = to_utc_iso(end, 3);
}

Json speed_table(const std::vector<SpeedRow>& rows, const Profile& profile,
                 std::optional<double> uncertainty_m_s) {
    Json table{{"units", Json::array()}, {"rows", Json::array()}};
    const auto units = units_in_order(profile);
    for (const SpeedUnit* unit : units)
        table["units"].push_back(unit->name);
    for (const SpeedRow& row : rows) {
        if (!row.speed_m_s) continue;
        Json entry{{"label", row.label}, {"cells", Json::array()}};
        for (const SpeedUnit* unit : units)
            entry["cells"].push_back(speed_cell(row, profile, uncertainty_m_s, *unit));
        table["rows"].push_back(std::move(entry));
    }
    return table;
}

Json window_json(const ProfileVerdict& verdict, const ProfileWindows* windows,
                 const Profile& profile) {
    Json json = members_json(*verdict.window);
    set_end(json, *verdict.window);
    Json facts = place_facts(*verdict.window);
    if (windows != nullptr && windows->best) {
        const CertifiableWindow& best = *windows->best;
        json["arc"] = best.arc;
        json["candidates"] = windows->candidates;
        json["displacement_m"] = rounded(best.displacement_m, 6);
        facts.push_back(
            fact("Distance between its ends", format_fixed(best.displacement_m, 3) + " m"));
        json["position_r95_m"] = rounded(best.position_r95_m, 6);
        facts.push_back(
            fact("Position at its ends, 95 % radius", format_fixed(best.position_r95_m, 3) + " m"));
        facts.push_back(fact("Windows compared", Json(windows->candidates).dump()));
        if (best.length_m) {
            json["length_m"] = rounded(*best.length_m, 6);
            facts.push_back(
                fact("Length that the speed is of", format_fixed(*best.length_m, 3) + " m"));
        }
        set_definitions(json, best, profile);
        set_further(json, *windows, profile);
        set_methods(json, best, profile);
        json["uncertainty"] = uncertainty_json(verdict, *windows, profile);
        set_reliability(json, best, {rule_unit(profile), verdict.coverage_factor});
        if (best.repaired_steps > 0)
            facts.push_back(fact("Steps inside it, bridged with their offsets as unknowns",
                                 Json(best.repaired_steps).dump()));
    }
    json["window_time"] = time_facts(*verdict.window);
    json["window_facts"] = std::move(facts);
    return json;
}

Json indicated_json(const ProfileVerdict& verdict, const Profile& profile) {
    const RefusedWindow& indicated = *verdict.indicated;
    Json json = members_json(indicated);
    set_end(json, indicated.span);
    json["indicated_speed"] = speed_beside(verdict, indicated.speed_m_s, rule_unit(profile).name);
    Json facts = time_facts(indicated.span);
    for (const Json& place : place_facts(indicated.span))
        facts.push_back(place);
    json["indicated_facts"] = std::move(facts);
    return json;
}

}  // namespace runcert
