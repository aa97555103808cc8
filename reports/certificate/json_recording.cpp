#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"
#include "reports/words/attempt.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

std::string innovations_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{}: mean square {} of {}, limits {} to {}; {} of {} outside, {} allowed",
                       health.consistent ? "passed" : "not passed",
                       format_fixed(health.mean_statistic, 3),
                       counted(health.innovations, "innovation"), format_fixed(health.lower, 3),
                       format_fixed(health.upper, 3), health.spans_outside,
                       counted(health.spans, "span"), health.spans_allowed);
}

std::string autocorrelation_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{} with noise as stated, {} with the noise used: {}",
                       format_fixed(health.autocorrelation_stated, 3),
                       format_fixed(health.autocorrelation, 3),
                       health.white ? "white" : "not white");
}

/// The lines of the table of noise, with their cells for one set of axes.
std::vector<std::pair<const char*, std::string>> noise_lines(const AxesEstimation& axes) {
    const NoiseSummary& noise = axes.noise;
    const FilterHealth& health = axes.health;
    const bool fitted = noise.status == NoiseBasis::fitted;
    const auto parameter = [&](const NoiseParameter& value, const char* unit) {
        return noise_parameter_text(value, noise, unit);
    };
    const auto of_error = [&](const std::optional<NoiseParameter>& value, const char* unit) {
        if (noise.correlated_error_detected && value) return parameter(*value, unit);
        return std::string(fitted ? "not determined by the data" : "not looked for");
    };
    return {
        {"Noise", noise_status_text(noise)},
        {"Jerk density of the motion", parameter(noise.jerk_density, "m s^-2.5")},
        {"Correlation time of the acceleration", noise.acceleration_time_s
                                                     ? parameter(*noise.acceleration_time_s, "s")
                                                     : "acceleration persists"},
        {"Scale of the stated standard deviations",
         fmt::format("{}; stated {} m, {}", parameter(noise.measurement_scale, ""),
                     significant_text(noise.stated_sigma_m, 2),
                     noise.stated_all_equal ? "equal at all epochs" : "root mean square")},
        {"Time-correlated position error, standard deviation", of_error(noise.error_sigma_m, "m")},
        {"its correlation time", of_error(noise.error_tau_s, "s")},
        {"its diffusion over short times", of_error(noise.error_diffusion, "m s^-0.5")},
        {"Search", fitted
                       ? fmt::format("{} after {} of the likelihood",
                                     noise.converged ? "converged" : "stopped before it converged",
                                     counted(noise.evaluations, "evaluation"))
                       : "none"},
        {"Autocorrelation of the innovations, lag 1", autocorrelation_text(health)},
        {"Innovation test", innovations_text(health)},
        {"Covariances", fmt::format("condition at most {}, asymmetry at most {}, {} repaired",
                                    significant_text(health.largest_condition, 3),
                                    scientific_text(health.largest_asymmetry), health.repaired)}};
}

/// The estimated noise, and whether filter and smoother behaved by it, as shown: a column for the
/// horizontal axes, and one for the vertical one where heights were measured.
Json noise_table(const EstimationSummary& estimation) {
    Json table{{"axes", Json::array({"Horizontal"})}, {"lines", Json::array()}};
    for (const auto& [label, text] : noise_lines(estimation.horizontal))
        table["lines"].push_back(
            {{"label", label}, {"cells", Json::array({{{"axis", "Horizontal"}, {"text", text}}})}});
    if (!estimation.vertical) return table;
    table["axes"].push_back("Vertical");
    std::size_t line = 0;
    for (const auto& [label, text] : noise_lines(*estimation.vertical))
        table["lines"][line++]["cells"].push_back({{"axis", "Vertical"}, {"text", text}});
    return table;
}

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
    const auto add = [&](const char* label, std::string value) {
        add_fact(facts, label, std::move(value));
    };
    add("Recording", recording["recording"].get<std::string>());
    add("Format", observations.format);
    if (const auto& processing = observations.processing; processing && !observations.simulated) {
        add("Positions", processing_text(*processing));
        if (!processing->begin.empty() && !processing->end.empty())
            add("Solved from, to", fmt::format("{}, {}", processing->begin, processing->end));
        if (!processing->options.empty())
            add("Options of the solution", fmt::format("{}", fmt::join(processing->options, "; ")));
    }
    add("Coordinates", observations.frame);
    add("Time scale", observations.time_scale);
    if (!observations.time_origin.empty()) add("Time stamps", observations.time_origin);
    add("Fix type", std::string(words_of(observations.solution_source)));
    if (const auto& first = observations.facts.first_epoch) {
        add("First epoch, UTC", utc_text(*first));
        add("First epoch, GPS time", gps_text(*first));
    }
    add("Epochs", counted(recording["screening"]["epochs"].get<int>(), "epoch"));
    if (const double interval = observations.facts.nominal_interval_s; interval > 0.0)
        add("Rate", format_fixed(1.0 / interval, 2) + " Hz");
    add("Length", format_fixed(recording["length_s"].get<double>(), 3) + " s");
    add("Heights", observations.facts.vertical_measured
                       ? "measured"
                       : "not measured: the estimate is in the plane");
    const Json& stated = recording["stated"];
    const auto add_stated = [&](const char* label, const char* key, const char* unit = " m") {
        if (stated.contains(key)) add(label, stated[key].dump() + unit);
    };
    if (!observations.facts.vertical_measured)
        add_stated("Height of the course stated by the attempt", "height_m");
    add("Accuracy stated", accuracy_words(observations.accuracy_source));
    add_stated("Horizontal accuracy stated, each coordinate", "accuracy_horizontal_m");
    add_stated("Vertical accuracy stated", "accuracy_vertical_m");
    add_stated("Accuracy of velocities stated by the attempt", "accuracy_velocity_m_s", " m/s");
    add_stated("Antenna above the ground", "antenna_height_m");
    add("Calibration", stated.contains("calibration")
                           ? stated["calibration"]["calibration_words"].get<std::string>()
                           : "none is stated");
    return facts;
}

Json estimation_facts(const Json& estimation) {
    Json facts = Json::array();
    const auto add = [&](const char* label, std::string value) {
        add_fact(facts, label, std::move(value));
    };
    add("Degrees of freedom", estimation["degrees_of_freedom"].dump());
    add("Variance of unit weight, a posteriori",
        format_fixed(estimation["variance_factor"].get<double>(), 2));
    const bool estimated = estimation.contains("horizontal");
    add_fact(facts,
             estimated ? "Factor on the stated covariances, horizontal"
                       : "Factor applied to all covariances",
             format_fixed(estimation["variance_factor_applied"].get<double>(), 2));
    if (estimated) {
        add("Stretches solved by batch least squares", estimation["batch_stretches"].dump());
        add("Epochs at less than half weight in the robust estimate",
            estimation["robust_downweighted"].dump());
    }
    add("Smoother and batch least squares, largest difference of position",
        scientific_text(estimation["largest_position_difference_m"].get<double>()) + " m");
    add("and of velocity",
        scientific_text(estimation["largest_velocity_difference_m_s"].get<double>()) + " m/s");
    return facts;
}

/// Who says what the recordings do not.
void add_sources(Json& facts, const Attempt& attempt) {
    if (attempt.wind) add_fact(facts, "Wind, by", attempt.wind->source);
    if (attempt.current) add_fact(facts, "Current, by", attempt.current->source);
    if (attempt.secondary_method)
        add_fact(facts, "Second method",
                 fmt::format("{} ({})", attempt.secondary_method->method,
                             attempt.secondary_method->source));
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
    add_fact(facts, "Attempt", attempt.id);
    add_fact(facts, "Craft", attempt.craft.name);
    add_fact(facts, "Class", attempt.craft.kind);
    if (!attempt.place.empty()) add_fact(facts, "Place", attempt.place);
    if (!attempt.date.empty()) add_fact(facts, "Date", attempt.date);
    if (verdict.record)
        add_fact(facts, "Record to beat",
                 fmt::format("{} {} ({})", Json(verdict.record->speed).dump(), verdict.record->unit,
                             verdict.record->source));
    else
        add_fact(facts, "Record to beat", "none is named");
    add_sources(facts, attempt);
    json["facts"] = std::move(facts);
    return json;
}

Json frame_json(const ReportInputs& inputs) {
    const ScreenedTable& table = inputs.receivers.front().screened;
    Json json{{"georeferenced", table.facts.georeferenced}};
    Json facts = Json::array();
    if (!table.facts.georeferenced)
        add_fact(facts, "Coordinates",
                 "engineering CRS: its place, orientation and scale on the Earth are not stated");
    if (table.origin) {
        const Geodetic& position = table.origin->position;
        json["origin"] = {{"latitude_deg", rounded(position.latitude.degrees(), 11)},
                          {"longitude_deg", rounded(position.longitude.degrees(), 11)},
                          {"height_m", rounded(position.height_m, 6)},
                          {"chosen_by", table.origin->source}};
        add_fact(facts, "Coordinates", "east, north, up on the WGS 84 ellipsoid");
        add_fact(facts, "Origin, latitude", format_fixed(position.latitude.degrees(), 9) + "°");
        add_fact(facts, "Origin, longitude", format_fixed(position.longitude.degrees(), 9) + "°");
        add_fact(facts, "Origin, ellipsoidal height", format_fixed(position.height_m, 3) + " m");
        add_fact(facts, "Chosen by",
                 table.origin->source == "attempt" ? "the attempt" : "the first usable position");
        for (const FramePlace& place : table.origin->places)
            add_fact(facts, "Another place, from", place_text(place));
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
    json["noise_table"] = noise_table(results.trajectory.estimation);
    return json;
}

}  // namespace runcert
