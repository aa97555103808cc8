#include <algorithm>

#include "core/rounding.h"
#include "reports/certificate/json_parts.h"
#include "reports/results/results.h"
#include "reports/words/attempt.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

constexpr std::ptrdiff_t faults_listed = 20;

void set_text(Json& json, const char* name, const std::string& text) {
    if (!text.empty()) json[name] = text;
}

Json official_json(const Official& official) {
    Json json{{"role", official.role}};
    set_text(json, "official_name", official.name);
    set_text(json, "key", official.key);
    return json;
}

Json calibration_json(const Calibration& calibration) {
    Json json{{"certificate_number", calibration.certificate},
              {"laboratory", calibration.laboratory},
              {"calibration_date", calibration.date}};
    if (calibration.expanded_uncertainty) {
        json["expanded_uncertainty"] = *calibration.expanded_uncertainty;
        json["unit"] = calibration.unit;
        json["of"] = calibration.quantity;
    }
    json["calibration_words"] = calibration_text(calibration);
    return json;
}

/// What is stated of the receiver in the attempt.
Json stated_json(const Receiver& receiver) {
    Json json = Json::object();
    const auto set = [&](const char* key, const std::optional<double>& value) {
        if (value) json[key] = *value;
    };
    set("antenna_height_m", receiver.antenna_height_m);
    set("height_m", receiver.height_m);
    const AttemptAccuracy accuracy = receiver.accuracy.value_or(AttemptAccuracy{});
    set("accuracy_horizontal_m", accuracy.horizontal_m);
    set("accuracy_vertical_m", accuracy.vertical_m);
    set("accuracy_velocity_m_s", accuracy.velocity_m_s);
    if (receiver.calibration) json["calibration"] = calibration_json(*receiver.calibration);
    if (receiver.instrument) json["instrument"] = members_json(*receiver.instrument);
    return json;
}

Json screening_json(const ScreenedTable& table) {
    const ScreeningSummary summary = summarise(table.rows);
    Json json{{"epochs", table.rows.size()},
              {"usable", summary.usable},
              {"arcs", summary.arcs},
              {"longest_arc_s", rounded(longest_arc_s(table.rows), 9)},
              {"variance_factor", rounded(table.variance_factor, 4)},
              {"reasons", Json::array()}};
    for (const auto& [reason, count] : summary.reasons)
        json["reasons"].push_back({{"reason", to_text(reason)}, {"count", count}});
    json["decisions"] = Json::array();
    for (const auto& [hypothesis, count] : summary.decisions)
        json["decisions"].push_back({{"hypothesis", to_text(hypothesis)}, {"count", count}});
    Json& basis = json["basis"] = members_json(table.basis);
    Json& faults = basis["time"]["faults"];
    if (std::ssize(table.basis.time.faults) > faults_listed)
        faults.erase(faults.begin() + faults_listed, faults.end());
    basis["time"]["faults_found"] = time_stamp_faults(table.basis.time);
    return json;
}

}  // namespace

Json attempt_json(const Attempt& attempt, const Verdict& verdict) {
    Json json{{"id", attempt.id},
              {"craft_name", attempt.craft.name},
              {"craft_class", attempt.craft.kind}};
    set_text(json, "craft_registration", attempt.craft.registration);
    if (attempt.craft.sail_area_m2) json["sail_area_m2"] = *attempt.craft.sail_area_m2;
    set_text(json, "pilot", attempt.pilot);
    set_text(json, "organisation", attempt.organisation);
    set_text(json, "contact", attempt.contact);
    set_text(json, "place", attempt.place);
    set_text(json, "date", attempt.date);
    set_text(json, "utc_offset", attempt.utc_offset);
    json["officials"] = Json::array();
    for (const Official& official : attempt.officials)
        json["officials"].push_back(official_json(official));
    if (verdict.record) json["record"] = members_json(*verdict.record);
    return json;
}

Json profile_json(const ReportInputs& inputs, std::size_t index) {
    const ProfileVerdict& verdict = inputs.verdict.profiles[index];
    Json json = members_json(verdict);
    for (std::size_t i = 0; i < verdict.requirements.size(); ++i)
        for (std::size_t k = 0; k < verdict.requirements[i].figures.size(); ++k)
            json["requirements"][i]["figures"][k]["quantity_text"] =
                figure_value_text(verdict.requirements[i].figures[k]);
    if (const ProfileWindows* windows =
            windows_of(inputs.receivers.front().windows, verdict.profile))
        json["windows"] = members_json(*windows);
    return json;
}

Json frame_json(const ReportInputs& inputs) {
    const ScreenedTable& table = inputs.receivers.front().screened;
    Json json{{"georeferenced", table.facts.georeferenced}};
    if (!table.origin) return json;
    const Geodetic& position = table.origin->position;
    json["origin"] = {{"latitude_deg", rounded(position.latitude.degrees(), 11)},
                      {"longitude_deg", rounded(position.longitude.degrees(), 11)},
                      {"height_m", rounded(position.height_m, 6)},
                      {"chosen_by", table.origin->source}};
    return json;
}

Json receiver_json(const ReceiverResults& results, const Receiver& receiver) {
    const Observations& observations = results.observations;
    Json json{{"receiver", receiver.id},
              {"recording", recording_names(receiver)},
              {"format", observations.format},
              {"coordinates", observations.frame},
              {"time_scale", observations.time_scale},
              {"time_source", observations.facts.time_source},
              {"solution_source", to_text(observations.solution_source)},
              {"accuracy_source", observations.accuracy_source},
              {"vertical_measured", observations.facts.vertical_measured},
              {"nominal_interval_s", rounded(observations.facts.nominal_interval_s, 9)},
              {"length_s", rounded(last_time(results.screened.rows).seconds(), 9)}};
    if (!observations.written_by.empty()) json["written_by"] = observations.written_by;
    set_text(json, "device", observations.device);
    if (observations.instrument) json["instrument"] = members_json(*observations.instrument);
    if (observations.simulated) json["simulated"] = true;
    if (observations.processing) json["processing"] = members_json(*observations.processing);
    set_text(json, "time_origin", observations.time_origin);
    if (const auto& first = observations.facts.first_epoch) {
        json["first_epoch_gps"] = to_iso(*first, 9);
        json["first_epoch_utc"] = to_utc_iso(*first, 9);
    }
    json["stated"] = stated_json(receiver);
    json["notes"] = observations.notes;
    json["screening"] = screening_json(results.screened);
    json["estimation"] = members_json(results.trajectory.estimation);
    return json;
}

Json method_json(const ReportInputs& inputs) {
    Json json{{"stages", Json::array()}};
    for (const Header* header : headers_of(inputs.receivers.front(), inputs.verdict))
        json["stages"].push_back({{"stage", header->stage},
                                  {"stage_version", header->program_version},
                                  {"stage_revision", header->source_revision},
                                  {"stage_parameters", *header->parameters}});
    return json;
}

}  // namespace runcert
