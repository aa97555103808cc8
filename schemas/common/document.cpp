#include "schemas/common/document.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "store/yaml_output.h"

namespace runcert {
namespace {

void round_reals(nlohmann::ordered_json& value, const std::string& path,
                 const DocumentSchema& schema) {
    if (value.is_object()) {
        for (auto& [key, member] : value.items())
            round_reals(member, path.empty() ? key : path + "." + key, schema);
    } else if (value.is_array()) {
        for (auto& item : value)
            round_reals(item, path + "[]", schema);
    } else if (value.is_number_float()) {
        if (const FieldRule* rule = schema.find(path))
            value = rounded(value.get<double>(), rule->decimals);
    }
}

/// People read what a person writes. No text in it may contain anything invisible, or anything that
/// changes how the surrounding text looks, in whatever notation.
void require_shown(const YamlValue& value) {
    const auto require = [&value](std::string_view text) {
        if (const auto hidden = hidden_character(text))
            value.fail(fmt::format("the text \"{}\" holds {}, which cannot be shown as it stands",
                                   escape_for_message(text), *hidden),
                       "Remove that character");
    };
    const YamlNode& node = value.node();
    if (node.is_scalar()) require(node.scalar());
    if (value.is_list())
        for (const YamlValue& item : value.list())
            require_shown(item);
    for (const std::string& key : value.keys()) {
        require(key);
        require_shown(value[key]);
    }
}

}  // namespace

void round_to_table(nlohmann::ordered_json& document, const DocumentSchema& schema) {
    round_reals(document, "", schema);
}

YamlValue read_document(std::string_view text, const std::string& where,
                        const DocumentSchema& schema) {
    YamlValue document(parse_yaml(text, where), where);
    check_document(document, schema);
    return document;
}

void check_document(const YamlValue& document, const DocumentSchema& schema) {
    check_version(document, schema);
    schema.validate(document);
}

YamlValue parse_input(std::string_view text, const std::string& where,
                      const DocumentSchema& schema) {
    YamlValue document(parse_yaml(text, where), where);
    require_shown(document);
    const std::string& name = schema.name();
    const std::string follows = fmt::format("{}/{}", name, schema.version());
    const std::string remedy = fmt::format("{} {} begins with \"schema: {}\"",
                                           name == "attempt" ? "An" : "A", name, follows);
    if (!document.is_map())
        document.fail(fmt::format("this is not {} {}", name == "attempt" ? "an" : "a", name),
                      remedy);
    const YamlValue written = document["schema"];
    if (!written.exists())
        document.fail("the file does not say that it follows " + follows, remedy);
    if (const std::string said = written.text(); said.starts_with(name + "/") && said != follows)
        written.fail(
            fmt::format("version \"{}\" of {} is not known, this program reads {}",
                        escape_for_message(said.substr(name.size() + 1)), name, schema.version()),
            fmt::format("Write it as {}, by the fields of that version", follows));
    else if (said != follows)
        written.fail("the file does not say that it follows " + follows, remedy);
    return document;
}

YamlValue read_input(std::string_view text, const std::string& where, const DocumentSchema& schema,
                     Completeness completeness) {
    YamlValue document = parse_input(text, where, schema);
    schema.validate(document, completeness);
    return document;
}

std::string write_document(nlohmann::ordered_json document, const DocumentSchema& schema) {
    document["schema"] = {{"name", schema.name()}, {"version", schema.version()}};
    round_to_table(document, schema);
    check_document(YamlValue(yaml_node_of(document), schema.name() + " as written"), schema);
    return to_yaml_text(document);
}

}  // namespace runcert
