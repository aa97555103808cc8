#include "schemas/common/header.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/members.h"

namespace runcert {

YamlNode common_field_table_node();

using Json = nlohmann::ordered_json;

const DocumentSchema& header_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(common_field_table_node(), "schemas/common/v1.yaml");
    return schema;
}

Json header_json(const Header& header) {
    Json json;
    json["schema"] = {{"name", header.schema_name}, {"version", header.schema_version}};
    json["stage"] = {{"name", header.stage},
                     {"version", header.program_version},
                     {"source_revision", header.source_revision}};
    if (!header.programs.empty()) member::write(json["stage"], "programs", header.programs);
    member::write(json, "inputs", header.inputs);
    json["parameters"] = *header.parameters;
    if (!header.attempt->empty()) json["attempt"] = *header.attempt;
    return json;
}

Header read_header(const YamlValue& document) {
    Header header;
    header.schema_name = document["schema"]["name"].text();
    header.schema_version = document["schema"]["version"].text();
    header.stage = document["stage"]["name"].text();
    header.program_version = document["stage"]["version"].text();
    header.source_revision = document["stage"]["source_revision"].text();
    member::take(document["stage"], "programs", header.programs);
    member::take(document, "inputs", header.inputs);
    header.parameters = json_from_yaml(document["parameters"]);
    if (document["attempt"].exists()) header.attempt = json_from_yaml(document["attempt"]);
    return header;
}

void check_version(const YamlValue& document, const DocumentSchema& expected) {
    const std::string name = document["schema"]["name"].text();
    if (name != expected.name())
        throw Failure(document["schema"]["name"].place(),
                      fmt::format("this is a file of the schema \"{}\", expected \"{}\"",
                                  escape_for_message(name), expected.name()),
                      "Give the file that the stage expects");
    const std::string version = document["schema"]["version"].text();
    if (version != expected.version())
        throw Failure(document["schema"]["version"].place(),
                      fmt::format("version \"{}\" of the schema {} is not known, this program "
                                  "reads {}",
                                  escape_for_message(version), name, expected.version()),
                      "Certify the recording again with this program");
}

std::optional<GpsTime> read_gps_time(const YamlValue& value) {
    if (!value.exists()) return std::nullopt;
    try {
        return parse_gps_iso(value.text());
    } catch (const Failure& failure) {
        value.fail(failure.problem(), failure.remedy());
    }
}

Json json_from_yaml(const YamlValue& value) {
    if (!value.exists()) return nullptr;
    if (value.is_map()) {
        Json map = Json::object();
        for (const std::string& key : value.keys())
            map[key] = json_from_yaml(value[key]);
        return map;
    }
    if (value.is_list()) {
        Json list = Json::array();
        for (const YamlValue& item : value.list())
            list.push_back(json_from_yaml(item));
        return list;
    }
    const std::string text = value.text();
    if (value.node().is_quoted()) return text;
    if (text == "true" || text == "false") return text == "true";
    if (const auto integer = parse_integer(text)) return *integer;
    if (const auto real = parse_double(text)) return *real;
    return text;
}

Json body_of(std::string_view text, const std::string& where) {
    Json body = json_from_yaml(YamlValue(parse_yaml(text, where), where));
    for (const char* member : {"schema", "stage", "inputs", "parameters"})
        body.erase(member);
    return body;
}

}  // namespace runcert
