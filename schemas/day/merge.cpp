#include "schemas/day/merge.h"

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

struct TableLine {
    std::size_t number = 0;
    const FieldRule* rule = nullptr;
};

/// The field table of attempt by path: it is asked for every key of every attempt of a day.
const std::map<std::string, TableLine, std::less<>>& attempt_table() {
    static const auto table = [] {
        std::map<std::string, TableLine, std::less<>> lines;
        for (const FieldRule& rule : attempt_schema().fields())
            lines[rule.path] = {.number = lines.size(), .rule = &rule};
        return lines;
    }();
    return table;
}

bool has_type(const FieldRule& rule, const char* type) {
    return std::find(rule.types.begin(), rule.types.end(), type) != rule.types.end();
}

std::string below(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
}

Json scalar_of(const YamlValue& value, const std::string& path) {
    const std::string text = value.text();
    const auto line = attempt_table().find(path);
    if (line == attempt_table().end() || value.node().is_quoted()) return text;
    const FieldRule& rule = *line->second.rule;
    if (has_type(rule, "text")) return text;
    if (has_type(rule, "boolean") && (text == "true" || text == "false")) return text == "true";
    if (has_type(rule, "integer"))
        if (const auto integer = parse_integer(text)) return *integer;
    if (has_type(rule, "real"))
        if (const auto real = parse_double(text)) return *real;
    return text;
}

Json joined(const Json& base, const Json& over) {
    if (!base.is_object() || !over.is_object()) return over;
    Json result = base;
    for (const auto& [key, value] : over.items())
        result[key] = base.contains(key) ? joined(base[key], value) : value;
    return result;
}

/// Null and missing are the same to an attempt.
Json without_nulls(const Json& value) {
    if (!value.is_object()) return value;
    Json result = Json::object();
    for (const auto& [key, member] : value.items())
        if (!member.is_null()) result[key] = without_nulls(member);
    return result;
}

Json joined_receivers(const Json& defaults, const Json& own) {
    if (!own.is_array()) return own;
    Json receivers = Json::array();
    for (const Json& receiver : own) {
        Json result = receiver;
        for (const Json& base : defaults)
            if (receiver.is_object() && receiver.contains("id") && base["id"] == receiver["id"])
                result = joined(base, receiver);
        receivers.push_back(without_nulls(result));
    }
    return receivers;
}

}  // namespace

Json attempt_keys(const YamlValue& part, const std::string& path) {
    if (!part.exists()) return nullptr;
    if (part.is_map()) {
        Json map = Json::object();
        for (const std::string& key : part.keys())
            map[key] = attempt_keys(part[key], below(path, key));
        return map;
    }
    if (part.is_list()) {
        Json list = Json::array();
        for (const YamlValue& item : part.list())
            list.push_back(attempt_keys(item, path + "[]"));
        return list;
    }
    return scalar_of(part, path);
}

Json over_defaults(const Json& defaults, const Json& entry) {
    Json result = joined(defaults, entry);
    if (entry.contains("receivers"))
        result["receivers"] =
            joined_receivers(defaults.value("receivers", Json::array()), entry["receivers"]);
    return without_nulls(result);
}

Json in_table_order(const Json& keys, const std::string& path) {
    if (keys.is_array()) {
        Json list = Json::array();
        for (const Json& item : keys)
            list.push_back(in_table_order(item, path + "[]"));
        return list;
    }
    if (!keys.is_object()) return keys;
    const auto line_of = [&](const std::string& key) {
        const auto line = attempt_table().find(below(path, key));
        return line == attempt_table().end() ? attempt_table().size() : line->second.number;
    };
    std::vector<std::string> names;
    for (const auto& member : keys.items())
        names.push_back(member.key());
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
        return line_of(a) < line_of(b);
    });
    Json result = Json::object();
    for (const std::string& name : names)
        result[name] = in_table_order(keys[name], below(path, name));
    return result;
}

}  // namespace runcert
