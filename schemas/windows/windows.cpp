#include "schemas/windows/windows.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "schemas/common/document.h"

namespace runcert {

std::string_view windows_schema_text(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

const DocumentSchema& windows_schema() {
    static const DocumentSchema schema = DocumentSchema::parse(
        windows_schema_text("v1.yaml"), "schemas/windows/v1.yaml", &header_schema());
    return schema;
}

Json best_json(const CertifiableWindow& best) {
    Json json = window_span_json(best.span);
    json["arc"] = best.arc;
    json["speed_m_s"] = best.speed_mps;
    json["standard_uncertainty_m_s"] = best.standard_uncertainty_mps;
    json["displacement_m"] = best.displacement_m;
    json["position_r95_m"] = best.position_r95_m;
    json["definitions"] = {{"displacement_m_s", best.definitions.displacement_mps},
                           {"path_length_m_s", best.definitions.path_length_mps},
                           {"mean_n_plus_1_m_s", best.definitions.mean_n_plus_1_mps},
                           {"mean_n_m_s", best.definitions.mean_n_mps}};
    Json methods = Json::object();
    set_optional(methods, "smoothed_m_s", best.methods.smoothed_mps);
    set_optional(methods, "batch_m_s", best.methods.batch_mps);
    set_optional(methods, "v1_m_s", best.methods.v1_mps);
    set_optional(methods, "v2_m_s", best.methods.v2_mps);
    set_optional(methods, "kalman_m_s", best.methods.kalman_mps);
    json["methods"] = std::move(methods);
    return json;
}

CertifiableWindow read_best(const YamlValue& value) {
    const YamlValue definitions = value["definitions"];
    const YamlValue methods = value["methods"];
    return {.span = read_window_span(value),
            .arc = value["arc"].integer(),
            .speed_mps = value["speed_m_s"].real(),
            .standard_uncertainty_mps = value["standard_uncertainty_m_s"].real(),
            .displacement_m = value["displacement_m"].real(),
            .position_r95_m = value["position_r95_m"].real(),
            .definitions = {.displacement_mps = definitions["displacement_m_s"].real(),
                            .path_length_mps = definitions["path_length_m_s"].real(),
                            .mean_n_plus_1_mps = definitions["mean_n_plus_1_m_s"].real(),
                            .mean_n_mps = definitions["mean_n_m_s"].real()},
            .methods = {.smoothed_mps = methods["smoothed_m_s"].optional_real(),
                        .batch_mps = methods["batch_m_s"].optional_real(),
                        .v1_mps = methods["v1_m_s"].optional_real(),
                        .v2_mps = methods["v2_m_s"].optional_real(),
                        .kalman_mps = methods["kalman_m_s"].optional_real()}};
}

Json indicated_json(const IndicatedWindow& indicated) {
    Json json = window_span_json(indicated.span);
    json["speed_m_s"] = indicated.speed_mps;
    json["certifiable"] = indicated.refusals.empty();
    json["refusals"] = indicated.refusals;
    return json;
}

IndicatedWindow read_indicated(const YamlValue& value) {
    IndicatedWindow indicated{
        .span = read_window_span(value), .speed_mps = value["speed_m_s"].real(), .refusals = {}};
    for (const YamlValue& refusal : value["refusals"].list())
        indicated.refusals.push_back(refusal.text());
    return indicated;
}

}  // namespace

double SpeedDefinitions::by_name(std::string_view name) const {
    if (name == "displacement") return displacement_mps;
    if (name == "path_length") return path_length_mps;
    if (name == "mean_n_plus_1") return mean_n_plus_1_mps;
    if (name == "mean_n") return mean_n_mps;
    throw Failure("definition of speed", fmt::format("\"{}\" is not known", name),
                  "Use displacement, path_length, mean_n_plus_1 or mean_n");
}

std::string write_windows(const Windows& windows) {
    Json json = header_json(windows.header);
    json["receiver"] = windows.receiver;
    if (windows.first_epoch) json["first_epoch_gps"] = to_iso(*windows.first_epoch, 9);
    json["georeferenced"] = windows.georeferenced;
    json["profiles"] = Json::array();
    for (const ProfileWindows& profile : windows.profiles) {
        Json entry{{"profile", profile.profile},
                   {"duration_s", profile.duration_s},
                   {"definition", profile.definition},
                   {"candidates", profile.candidates}};
        if (profile.best) entry["best"] = best_json(*profile.best);
        if (profile.indicated) entry["indicated"] = indicated_json(*profile.indicated);
        json["profiles"].push_back(std::move(entry));
    }
    return write_document(std::move(json), windows_schema());
}

Windows read_windows(std::string_view text, const std::string& where) {
    const YamlValue document = read_document(text, where, windows_schema());
    Windows windows;
    windows.header = read_header(document);
    windows.receiver = document["receiver"].text();
    windows.first_epoch = read_gps_time(document["first_epoch_gps"]);
    windows.georeferenced = document["georeferenced"].boolean();
    for (const YamlValue& entry : document["profiles"].list()) {
        ProfileWindows profile{.profile = entry["profile"].text(),
                               .duration_s = entry["duration_s"].real(),
                               .definition = entry["definition"].text(),
                               .candidates = entry["candidates"].integer(),
                               .best = std::nullopt,
                               .indicated = std::nullopt};
        if (entry["best"].exists()) profile.best = read_best(entry["best"]);
        if (entry["indicated"].exists()) profile.indicated = read_indicated(entry["indicated"]);
        windows.profiles.push_back(std::move(profile));
    }
    return windows;
}

}  // namespace runcert
