#include "files/document_schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

FieldRule read_rule(const std::string& path, const YamlValue& entry) {
    FieldRule rule{.path = path, .default_value = entry["default"]};
    const std::string types = entry["type"].text();
    for (std::size_t begin = 0; begin <= types.size();) {
        const std::size_t end = std::min(types.find('|', begin), types.size());
        rule.types.push_back(types.substr(begin, end - begin));
        begin = end + 1;
    }
    rule.unit = entry["unit"].text_or("");
    rule.required = entry["required"].exists() && entry["required"].boolean();
    for (const YamlValue& value : entry["values"].list())
        rule.values.push_back(value.text());
    rule.minimum = entry["min"].optional_real();
    rule.maximum = entry["max"].optional_real();
    rule.decimals = static_cast<int>(entry["decimals"].optional_integer().value_or(6));
    rule.description = entry["description"].text();
    return rule;
}

bool has_type(const FieldRule& rule, std::string_view type) {
    return std::find(rule.types.begin(), rule.types.end(), type) != rule.types.end();
}

void check_range(const FieldRule& rule, const YamlValue& value, double number) {
    const std::string unit = rule.unit.empty() ? "" : " " + rule.unit;
    if (rule.minimum && number < *rule.minimum)
        value.fail(fmt::format("{} is below {}{}", number, *rule.minimum, unit),
                   "Give a value in the range");
    if (rule.maximum && number > *rule.maximum)
        value.fail(fmt::format("{} is above {}{}", number, *rule.maximum, unit),
                   "Give a value in the range");
}

void check_values(const FieldRule& rule, const YamlValue& value) {
    if (rule.values.empty()) return;
    const std::string text = value.text();
    if (std::find(rule.values.begin(), rule.values.end(), text) == rule.values.end())
        value.fail(fmt::format("\"{}\" is not one of {}", escape_for_message(text),
                               fmt::join(rule.values, ", ")),
                   "Give one of these");
}

void check_scalar(const FieldRule& rule, const YamlValue& value) {
    if (has_type(rule, "text")) {
        check_values(rule, value);
    } else if (has_type(rule, "integer")) {
        check_range(rule, value, static_cast<double>(value.integer()));
    } else if (has_type(rule, "real")) {
        check_range(rule, value, value.real());
    } else if (has_type(rule, "boolean")) {
        value.boolean();
    } else {
        value.fail(fmt::format("is a single value, not a {}", fmt::join(rule.types, " or ")),
                   "See the field table of the schema");
    }
}

}  // namespace

DocumentSchema DocumentSchema::parse(std::string_view text, const std::string& where,
                                     const DocumentSchema* common) {
    DocumentSchema schema;
    schema.source_ = YamlValue(parse_yaml(text, where), where);
    schema.name_ = schema.source_["schema"].text();
    schema.version_ = schema.source_["version"].text();
    if (common) schema.fields_ = common->fields_;
    const YamlValue fields = schema.source_["fields"];
    for (const std::string& path : fields.keys())
        schema.fields_.push_back(read_rule(path, fields[path]));
    return schema;
}

const FieldRule* DocumentSchema::find(std::string_view path) const {
    for (const FieldRule& rule : fields_)
        if (rule.path == path) return &rule;
    return nullptr;
}

void DocumentSchema::validate(const YamlValue& document, bool newer_revision) const {
    if (!document.is_map())
        document.fail("the document is not a map of keys and values",
                      fmt::format("See the field table of {}/{}", name_, version_));
    validate_map(document, "", newer_revision);
}

std::vector<std::string_view> DocumentSchema::children(const std::string& path) const {
    std::vector<std::string_view> names;
    const std::string prefix = path.empty() ? "" : path + ".";
    for (const FieldRule& rule : fields_) {
        if (!rule.path.starts_with(prefix)) continue;
        const std::string_view rest = std::string_view(rule.path).substr(prefix.size());
        if (rest.find('.') == std::string_view::npos && !rest.ends_with("[]") && rest != "*")
            names.push_back(rest);
    }
    return names;
}

void DocumentSchema::validate_map(const YamlValue& value, const std::string& path,
                                  bool newer) const {
    const std::string prefix = path.empty() ? "" : path + ".";
    const std::vector<std::string_view> known = children(path);
    for (const std::string& key : value.keys()) {
        // Not by the whole path: a key may be written "craft.name", which is no field.
        if (std::find(known.begin(), known.end(), key) != known.end()) {
            validate_node(value[key], prefix + key, newer);
        } else if (find(prefix + "*")) {
            validate_node(value[key], prefix + "*", newer);
        } else if (!newer) {
            YAML::Node key_node;
            for (const auto& pair : value.node())
                if (pair.first.Scalar() == key) key_node.reset(pair.first);
            const std::string remedy =
                known.empty() ? "Remove it"
                              : fmt::format("Did you mean \"{}\"? Known keys here: {}",
                                            nearest(key, known), fmt::join(known, ", "));
            throw Failure(yaml_place(value.where(), key_node),
                          fmt::format("unknown key \"{}\"{}", escape_for_message(key),
                                      path.empty() ? "" : " in " + path),
                          remedy);
        }
    }
    for (const std::string_view name : known) {
        const FieldRule& rule = *find(prefix + std::string(name));
        if (rule.required && !value[std::string(name)].exists())
            value.fail(fmt::format("the key \"{}\" is missing ({})", name, rule.description),
                       "Add it");
    }
}

void DocumentSchema::validate_node(const YamlValue& value, const std::string& path,
                                   bool newer) const {
    const FieldRule& rule = *find(path);
    if (!value.exists() || has_type(rule, "any")) return;
    if (value.is_map() && has_type(rule, "map")) return validate_map(value, path, newer);
    if (value.is_list() && has_type(rule, "list")) {
        for (const YamlValue& item : value.list()) {
            if (!item.exists()) item.fail("is empty", "Give it a value, or remove it");
            if (find(path + "[]")) validate_node(item, path + "[]", newer);
        }
        return;
    }
    if (value.is_map() || value.is_list())
        value.fail(fmt::format("is a {}, not {}", value.is_map() ? "map" : "list",
                               fmt::join(rule.types, " or ")),
                   "See the field table of the schema");
    check_scalar(rule, value);
}

std::string DocumentSchema::field_table() const {
    std::string out;
    for (const FieldRule& rule : fields_) {
        std::string facts = fmt::format("{}", fmt::join(rule.types, " or "));
        if (!rule.unit.empty()) facts += ", " + rule.unit;
        if (rule.required) facts += ", required";
        if (!rule.values.empty()) facts += fmt::format(", one of: {}", fmt::join(rule.values, " "));
        out += fmt::format("  {:<42} {} ({})\n", rule.path, rule.description, facts);
    }
    return out;
}

}  // namespace runcert
