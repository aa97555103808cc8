#include "schemas/verdict/verdict.h"

#include "schemas/common/document.h"

namespace runcert {

std::string_view verdict_schema_text(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

const DocumentSchema& verdict_schema() {
    static const DocumentSchema schema = DocumentSchema::parse(
        verdict_schema_text("v1.yaml"), "schemas/verdict/v1.yaml", &header_schema());
    return schema;
}

/// A speed in the four units people use (knot 1852 m/h, statute mile 1609.344 m, both exact).
void set_speed(Json& json, const std::string& name, const std::optional<double>& speed_mps) {
    if (!speed_mps) return;
    json[name + "_km_h"] = *speed_mps * 3.6;
    json[name + "_m_s"] = *speed_mps;
    json[name + "_knots"] = *speed_mps * 3600.0 / 1852.0;
    json[name + "_mph"] = *speed_mps * 3600.0 / 1609.344;
}

Json requirement_json(const Requirement& requirement) {
    return {{"clause", requirement.clause},     {"status", requirement.status},
            {"evidence", requirement.evidence}, {"text", requirement.text},
            {"source", requirement.source},     {"certainty", requirement.certainty}};
}

Json profile_json(const ProfileVerdict& profile) {
    Json json{{"profile", profile.profile}, {"body", profile.body},
              {"title", profile.title},     {"outcome", profile.outcome},
              {"reason", profile.reason},   {"definition", profile.definition}};
    set_speed(json, "speed", profile.speed_mps);
    set_speed(json, "expanded_uncertainty", profile.expanded_uncertainty_mps);
    json["coverage_factor"] = profile.coverage_factor;
    set_speed(json, "target", profile.target_mps);
    if (profile.window) json["window"] = window_span_json(*profile.window);
    json["requirements"] = Json::array();
    for (const Requirement& requirement : profile.requirements)
        json["requirements"].push_back(requirement_json(requirement));
    if (profile.indicated) {
        Json indicated = window_span_json(profile.indicated->span);
        set_speed(indicated, "speed", profile.indicated->speed_mps);
        indicated["refusals"] = profile.indicated->refusals;
        json["indicated"] = std::move(indicated);
    }
    return json;
}

ProfileVerdict read_profile_verdict(const YamlValue& value) {
    ProfileVerdict profile;
    profile.profile = value["profile"].text();
    profile.body = value["body"].text();
    profile.title = value["title"].text();
    profile.outcome = value["outcome"].text();
    profile.reason = value["reason"].text();
    profile.definition = value["definition"].text();
    profile.coverage_factor = value["coverage_factor"].real();
    profile.speed_mps = value["speed_m_s"].optional_real();
    profile.expanded_uncertainty_mps = value["expanded_uncertainty_m_s"].optional_real();
    profile.target_mps = value["target_m_s"].optional_real();
    if (value["window"].exists()) profile.window = read_window_span(value["window"]);
    for (const YamlValue& entry : value["requirements"].list())
        profile.requirements.push_back({.clause = entry["clause"].text(),
                                        .status = entry["status"].text(),
                                        .evidence = entry["evidence"].text(),
                                        .text = entry["text"].text(),
                                        .source = entry["source"].text(),
                                        .certainty = entry["certainty"].text()});
    if (const YamlValue indicated = value["indicated"]; indicated.exists()) {
        profile.indicated = RefusedWindow{.span = read_window_span(indicated),
                                          .speed_mps = indicated["speed_m_s"].real(),
                                          .refusals = {}};
        for (const YamlValue& refusal : indicated["refusals"].list())
            profile.indicated->refusals.push_back(refusal.text());
    }
    return profile;
}

}  // namespace

std::string write_verdict(const Verdict& verdict) {
    Json json = header_json(verdict.header);
    json["attempt"] = verdict.attempt;
    json["receiver"] = verdict.receiver;
    json["georeferenced"] = verdict.georeferenced;
    if (verdict.record)
        json["record"] = {{"speed", verdict.record->speed},
                          {"unit", verdict.record->unit},
                          {"source", verdict.record->source},
                          {"speed_km_h", verdict.record->speed_mps * 3.6}};
    json["statements"] = verdict.statements;
    json["profiles"] = Json::array();
    for (const ProfileVerdict& profile : verdict.profiles)
        json["profiles"].push_back(profile_json(profile));
    return write_document(std::move(json), verdict_schema());
}

Verdict read_verdict(std::string_view text, const std::string& where) {
    const YamlValue document = read_document(text, where, verdict_schema());
    Verdict verdict;
    verdict.header = read_header(document);
    verdict.attempt = document["attempt"].text();
    verdict.receiver = document["receiver"].text();
    verdict.georeferenced = document["georeferenced"].boolean();
    if (const YamlValue record = document["record"]; record.exists())
        verdict.record = RecordToBeat{.speed = record["speed"].real(),
                                      .unit = record["unit"].text(),
                                      .source = record["source"].text(),
                                      .speed_mps = record["speed_km_h"].real() / 3.6};
    for (const YamlValue& statement : document["statements"].list())
        verdict.statements.push_back(statement.text());
    for (const YamlValue& profile : document["profiles"].list())
        verdict.profiles.push_back(read_profile_verdict(profile));
    return verdict;
}

}  // namespace runcert
