#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_facts.h"
#include "reports/certificate/json_noise.h"
#include "reports/certificate/json_parts.h"
#include "reports/certificate/json_rule.h"
#include "reports/certificate/json_screening.h"
#include "reports/words/estimation.h"
#include "reports/words/phases.h"
#include "reports/words/recording.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

std::string accuracy_words(const std::string& source) {
    if (source == "recording") return "in the recording";
    if (source == "attempt") return "in the attempt";
    return "nowhere";
}

Json official_json(const Official& official) {
    Json json{{"role", official.role}};
    if (!official.name.empty()) json["official_name"] = official.name;
    if (!official.key.empty()) json["key"] = official.key;
    return json;
}

/// What is stated of the receiver in the attempt.
Json stated_json(const Receiver& receiver) {
    Json json = Json::object();
    if (receiver.antenna_height_m) json["antenna_height_m"] = *receiver.antenna_height_m;
    if (receiver.height_m) json["height_m"] = *receiver.height_m;
    if (receiver.accuracy) {
        const AttemptAccuracy& accuracy = *receiver.accuracy;
        if (accuracy.horizontal_m) json["accuracy_horizontal_m"] = *accuracy.horizontal_m;
        if (accuracy.vertical_m) json["accuracy_vertical_m"] = *accuracy.vertical_m;
        if (accuracy.velocity_m_s) json["accuracy_velocity_m_s"] = *accuracy.velocity_m_s;
    }
    return json;
}

ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows) {
    ElapsedTime last;
    for (const ScreenedEpoch& row : rows)
        last = std::max(last, row.time);
    return last;
}

Json recording_facts(const ReceiverResults& results, const Json& recording) {
    const Observations& observations = results.observations;
    Json facts = Json::array();
    facts.push_back(fact("Recording", recording["recording"].get<std::string>()));
    facts.push_back(fact("Format", observations.format));
    if (const auto& processing = observations.processing; processing && !observations.simulated) {
        facts.push_back(fact("Positions", processing_text(*processing)));
        if (!processing->begin.empty() && !processing->end.empty())
            facts.push_back(
                fact("Solved from, to", fmt::format("{}, {}", processing->begin, processing->end)));
        if (!processing->options.empty())
            facts.push_back(fact("Options of the solution",
                                 fmt::format("{}", fmt::join(processing->options, "; "))));
    }
    facts.push_back(fact("Coordinates", observations.frame));
    facts.push_back(fact("Time scale", observations.time_scale));
    if (!observations.time_origin.empty())
        facts.push_back(fact("Time stamps", observations.time_origin));
    facts.push_back(fact("Fix type", std::string(words_of(observations.solution_source))));
    if (const auto& first = observations.facts.first_epoch) {
        facts.push_back(fact("First epoch, UTC", utc_text(*first)));
        facts.push_back(fact("First epoch, GPS time", gps_text(*first)));
    }
    facts.push_back(fact("Epochs", counted(recording["screening"]["epochs"].get<int>(), "epoch")));
    if (const double interval = observations.facts.nominal_interval_s; interval > 0.0)
        facts.push_back(fact("Rate", format_fixed(1.0 / interval, 2) + " Hz"));
    facts.push_back(fact("Length", format_fixed(recording["length_s"].get<double>(), 3) + " s"));
    facts.push_back(fact("Heights", observations.facts.vertical_measured
                                        ? "measured"
                                        : "not measured: the estimate is in the plane"));
    if (const Json& stated = recording["stated"];
        stated.contains("height_m") && !observations.facts.vertical_measured)
        facts.push_back(
            fact("Height of the course stated by the attempt", stated["height_m"].dump() + " m"));
    facts.push_back(fact("Accuracy stated", accuracy_words(observations.accuracy_source)));
    const Json& stated = recording["stated"];
    if (stated.contains("accuracy_horizontal_m"))
        facts.push_back(fact("Horizontal accuracy stated, each coordinate",
                             stated["accuracy_horizontal_m"].dump() + " m"));
    if (stated.contains("accuracy_vertical_m"))
        facts.push_back(
            fact("Vertical accuracy stated", stated["accuracy_vertical_m"].dump() + " m"));
    if (stated.contains("accuracy_velocity_m_s"))
        facts.push_back(fact("Accuracy of velocities stated by the attempt",
                             stated["accuracy_velocity_m_s"].dump() + " m/s"));
    if (stated.contains("antenna_height_m"))
        facts.push_back(fact("Antenna above the ground", stated["antenna_height_m"].dump() + " m"));
    return facts;
}

Json estimation_facts(const Json& estimation) {
    Json facts = Json::array();
    facts.push_back(fact("Degrees of freedom", estimation["degrees_of_freedom"].dump()));
    facts.push_back(fact("Variance of unit weight, a posteriori",
                         format_fixed(estimation["variance_factor"].get<double>(), 2)));
    const bool estimated = estimation.contains("horizontal");
    facts.push_back(fact(estimated ? "Factor on the stated covariances, horizontal"
                                   : "Factor applied to all covariances",
                         format_fixed(estimation["variance_factor_applied"].get<double>(), 2)));
    if (estimated) {
        facts.push_back(
            fact("Stretches solved by batch least squares", estimation["batch_stretches"].dump()));
        facts.push_back(fact("Epochs at less than half weight in the robust estimate",
                             estimation["robust_downweighted"].dump()));
    }
    facts.push_back(
        fact("Smoother and batch least squares, largest difference of position",
             scientific_text(estimation["largest_position_difference_m"].get<double>()) + " m"));
    facts.push_back(fact(
        "and of velocity",
        scientific_text(estimation["largest_velocity_difference_m_s"].get<double>()) + " m/s"));
    return facts;
}

/// Who says what the recordings do not.
void add_sources(Json& facts, const Attempt& attempt) {
    if (attempt.wind) facts.push_back(fact("Wind, by", attempt.wind->source));
    if (attempt.current) facts.push_back(fact("Current, by", attempt.current->source));
    if (attempt.secondary_method)
        facts.push_back(
            fact("Second method", fmt::format("{} ({})", attempt.secondary_method->method,
                                              attempt.secondary_method->source)));
}

}  // namespace

Json attempt_json(const Attempt& attempt, const Verdict& verdict) {
    Json json{{"id", attempt.id},
              {"craft_name", attempt.craft.name},
              {"craft_class", attempt.craft.kind}};
    if (!attempt.place.empty()) json["place"] = attempt.place;
    if (!attempt.date.empty()) json["date"] = attempt.date;
    json["officials"] = Json::array();
    for (const Official& official : attempt.officials)
        json["officials"].push_back(official_json(official));
    if (verdict.record) json["record"] = record_json(*verdict.record);
    Json facts = Json::array();
    facts.push_back(fact("Attempt", attempt.id));
    facts.push_back(fact("Craft", attempt.craft.name));
    facts.push_back(fact("Class", attempt.craft.kind));
    if (!attempt.place.empty()) facts.push_back(fact("Place", attempt.place));
    if (!attempt.date.empty()) facts.push_back(fact("Date", attempt.date));
    if (verdict.record)
        facts.push_back(
            fact("Record to beat", fmt::format("{} {} ({})", Json(verdict.record->speed).dump(),
                                               verdict.record->unit, verdict.record->source)));
    else
        facts.push_back(fact("Record to beat", "none is named"));
    add_sources(facts, attempt);
    json["facts"] = std::move(facts);
    return json;
}

Json frame_json(const ReportInputs& inputs) {
    const ScreenedTable& table = inputs.receivers.front().screened;
    Json json{{"georeferenced", table.facts.georeferenced}};
    Json facts = Json::array();
    if (!table.facts.georeferenced)
        facts.push_back(
            fact("Coordinates",
                 "engineering CRS: its place, orientation and scale on the Earth are not "
                 "stated"));
    if (table.origin) {
        const Geodetic& position = table.origin->position;
        json["origin"] = {{"latitude_deg", rounded(position.latitude.degrees(), 11)},
                          {"longitude_deg", rounded(position.longitude.degrees(), 11)},
                          {"height_m", rounded(position.height_m, 6)},
                          {"chosen_by", table.origin->source}};
        facts.push_back(fact("Coordinates", "east, north, up on the WGS 84 ellipsoid"));
        facts.push_back(
            fact("Origin, latitude", format_fixed(position.latitude.degrees(), 9) + "°"));
        facts.push_back(
            fact("Origin, longitude", format_fixed(position.longitude.degrees(), 9) + "°"));
        facts.push_back(
            fact("Origin, ellipsoidal height", format_fixed(position.height_m, 3) + " m"));
        facts.push_back(fact("Chosen by", table.origin->source == "attempt"
                                              ? "the attempt"
                                              : "the first usable position"));
        for (const FramePlace& place : table.origin->places)
            facts.push_back(fact("Another place, from", place_text(place)));
    }
    json["facts"] = std::move(facts);
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
    if (observations.simulated) json["simulated"] = true;
    if (observations.processing) json["processing"] = members_json(*observations.processing);
    if (!observations.time_origin.empty()) json["time_origin"] = observations.time_origin;
    if (const auto& first = observations.facts.first_epoch) {
        json["first_epoch_gps"] = to_iso(*first, 9);
        json["first_epoch_utc"] = to_utc_iso(*first, 9);
    }
    json["stated"] = stated_json(receiver);
    json["notes"] = observations.notes;
    if (results.phases)
        for (const std::string& sentence : phase_sentences(*results.phases))
            json["notes"].push_back(sentence);
    json["screening"] = screening_json(results.screened);
    json["estimation"] = members_json(results.trajectory.estimation);
    json["recording_facts"] = recording_facts(results, json);
    json["screening_facts"] = screening_facts(results.screened);
    json["estimation_facts"] = estimation_facts(json["estimation"]);
    if (Json table = noise_table(results.trajectory.estimation); !table.is_null())
        json["noise_table"] = std::move(table);
    return json;
}

}  // namespace runcert
