#include "schemas/verdict/verdict.h"

#include "schemas/common/document.h"
#include "schemas/common/members.h"

namespace runcert {

YamlNode verdict_field_table_node();

using Json = nlohmann::ordered_json;

// Members as `schemas/verdict/v1.yaml` names them.

template <>
inline constexpr auto members<Figure> = std::tuple{
    Member{"name", &Figure::name}, Member{"value", &Figure::value}, Member{"unit", &Figure::unit},
    Member{"expanded_uncertainty", &Figure::expanded_uncertainty}, Member{"note", &Figure::note}};

template <>
inline constexpr auto members<Requirement> = std::tuple{
    Member{"clause", &Requirement::clause},         Member{"status", &Requirement::status},
    Member{"evidence", &Requirement::evidence},     Member{"text", &Requirement::text},
    Member{"source", &Requirement::source},         Member{"certainty", &Requirement::certainty},
    Member{"decided_by", &Requirement::decided_by}, Member{"figures", &Requirement::figures}};

template <>
inline constexpr auto members<Override> =
    std::tuple{Member{"figure", &Override::figure}, Member{"rule", &Override::rule},
               Member{"used", &Override::used}, Member{"unit", &Override::unit},
               Member{"reason", &Override::reason}};

template <>
inline constexpr auto members<Decision> = std::tuple{
    Member{"probability", &Decision::probability},
    Member{"level", &Decision::level},
    Member{"target_standard_uncertainty_m_s", &Decision::target_standard_uncertainty_mps},
    Member{"acceptance_limit_m_s", &Decision::acceptance_limit_mps},
    Member{"risk", &Decision::risk},
    Member{"attempts_made", &Decision::attempts_made},
    Member{"bias_limit_m_s", &Decision::bias_limit_mps},
    Member{"drift_survived_m", &Decision::drift_survived_m},
    Member{"drift_found_m_s", &Decision::drift_found_mps}};

template <>
inline constexpr auto members<ShownFigures> =
    std::tuple{Member{"unit", &ShownFigures::unit}, Member{"speed", &ShownFigures::speed},
               Member{"expanded_uncertainty", &ShownFigures::expanded_uncertainty},
               Member{"target", &ShownFigures::target}};

template <>
inline constexpr auto members<RunSummary> = std::tuple{
    Member{"length_m", &RunSummary::length_m}, Member{"top_speed_m_s", &RunSummary::top_speed_mps},
    Member{"heading_deg", &RunSummary::heading_deg}, Member{"began", &RunSummary::began},
    Member{"ended", &RunSummary::ended}};

namespace {

const DocumentSchema& verdict_schema() {
    static const DocumentSchema schema = DocumentSchema::read(
        verdict_field_table_node(), "schemas/verdict/v1.yaml", &header_schema());
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

template <class Item>
Json list_json(const std::vector<Item>& items) {
    Json list = Json::array();
    for (const Item& item : items)
        list.push_back(members_json(item));
    return list;
}

template <class Item>
std::vector<Item> read_list(const YamlValue& value) {
    std::vector<Item> items;
    if (value.exists())
        for (const YamlValue& item : value.list())
            items.push_back(read_members<Item>(item));
    return items;
}

Json record_json(const RecordToBeat& record) {
    Json json{{"speed", record.speed},
              {"unit", record.unit},
              {"source", record.source},
              {"speed_km_h", record.speed_mps * 3.6}};
    return json;
}

RecordToBeat read_record(const YamlValue& value) {
    return {.speed = value["speed"].real(),
            .unit = value["unit"].text(),
            .source = value["source"].text(),
            .speed_mps = value["speed_km_h"].real() / 3.6,
            .expanded_uncertainty = value["expanded_uncertainty"].optional_real()};
}

Json run_json(const RunSummary& run) {
    Json json = window_span_json(run.span);
    json.update(members_json(run));
    return json;
}

/// What revision 1.1 added.
void write_additions(Json& json, const ProfileVerdict& profile) {
    if (profile.record) {
        json["record"] = record_json(*profile.record);
        set_optional(json["record"], "expanded_uncertainty", profile.record->expanded_uncertainty);
    }
    if (profile.decision) json["decision"] = members_json(*profile.decision);
    if (profile.shown) json["shown"] = members_json(*profile.shown);
    set_optional(json, "current_subtracted_m_s", profile.current_subtracted_mps);
    json["notes"] = profile.notes;
    json["overrides"] = list_json(profile.overrides);
    json["course"] = list_json(profile.course);
    json["witnesses"] = profile.witnesses;
    json["runs"] = Json::array();
    for (const RunSummary& run : profile.runs)
        json["runs"].push_back(run_json(run));
}

void read_additions(const YamlValue& value, ProfileVerdict& profile) {
    if (value["record"].exists()) profile.record = read_record(value["record"]);
    if (value["decision"].exists()) profile.decision = read_members<Decision>(value["decision"]);
    if (value["shown"].exists()) profile.shown = read_members<ShownFigures>(value["shown"]);
    profile.current_subtracted_mps = value["current_subtracted_m_s"].optional_real();
    if (value["notes"].exists())
        for (const YamlValue& note : value["notes"].list())
            profile.notes.push_back(note.text());
    if (value["witnesses"].exists())
        for (const YamlValue& witness : value["witnesses"].list())
            profile.witnesses.push_back(witness.text());
    profile.overrides = read_list<Override>(value["overrides"]);
    profile.course = read_list<Figure>(value["course"]);
    if (value["runs"].exists())
        for (const YamlValue& run : value["runs"].list()) {
            profile.runs.push_back(read_members<RunSummary>(run));
            profile.runs.back().span = read_window_span(run);
        }
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
    json["requirements"] = list_json(profile.requirements);
    if (profile.indicated) {
        Json indicated = window_span_json(profile.indicated->span);
        set_speed(indicated, "speed", profile.indicated->speed_mps);
        indicated["refusals"] = profile.indicated->refusals;
        json["indicated"] = std::move(indicated);
    }
    write_additions(json, profile);
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
    profile.requirements = read_list<Requirement>(value["requirements"]);
    if (const YamlValue indicated = value["indicated"]; indicated.exists()) {
        profile.indicated = RefusedWindow{.span = read_window_span(indicated),
                                          .speed_mps = indicated["speed_m_s"].real(),
                                          .refusals = {}};
        for (const YamlValue& refusal : indicated["refusals"].list())
            profile.indicated->refusals.push_back(refusal.text());
    }
    read_additions(value, profile);
    return profile;
}

}  // namespace

std::string write_verdict(const Verdict& verdict) {
    Json json = header_json(verdict.header);
    json["attempt"] = verdict.attempt;
    json["receiver"] = verdict.receiver;
    json["georeferenced"] = verdict.georeferenced;
    if (verdict.record) json["record"] = record_json(*verdict.record);
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
    if (document["record"].exists()) verdict.record = read_record(document["record"]);
    for (const YamlValue& statement : document["statements"].list())
        verdict.statements.push_back(statement.text());
    for (const YamlValue& profile : document["profiles"].list())
        verdict.profiles.push_back(read_profile_verdict(profile));
    return verdict;
}

}  // namespace runcert
