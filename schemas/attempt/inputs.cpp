#include <algorithm>
#include <utility>

#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

/// A part of the document: where it is in the schema, and what it is called.
struct Place {
    std::string path;
    std::string name;
    std::string profile = {};

    Place member(const std::string& key) const {
        const auto below = [&](const std::string& whole) {
            return whole.empty() ? key : whole + "." + key;
        };
        return {below(path), below(name), profile};
    }

    /// Of a list: by its own name where it has one, else counted from 1.
    Place item(const YamlValue& value, std::size_t index) const {
        Place below{path + "[]", name, profile};
        if (!value.is_map()) return below;
        below.profile = value["profile"].exists() ? profile_name(value["profile"].text()) : profile;
        below.name += '.';
        below.name +=
            value["id"].text_or(below.profile.empty() ? std::to_string(index + 1) : below.profile);
        return below;
    }
};

/// The name of a rule that comes with the program is the body's, not the attempt's.
bool is_rule_of_the_program(const Place& place, const YamlValue& value) {
    return place.path == "profiles[]" && !value.text().ends_with(".yaml");
}

bool is_default(const FieldRule& rule, const YamlValue& value) {
    const YamlValue& usual = rule.default_value;
    return usual.exists() && !usual.is_map() && !usual.is_list() && usual.text() == value.text();
}

void add(const Place& place, const YamlValue& value, std::vector<AttemptInput>& inputs) {
    const FieldRule& rule = *attempt_schema().find(place.path);
    const FieldOrigin* const origin = attempt_schema().origin_of(place.path);
    if (origin == nullptr || origin->changes.empty()) return;
    const bool decides = std::ranges::count(origin->changes, "outcome") > 0;
    if (is_rule_of_the_program(place, value) || (is_default(rule, value) && !decides)) return;
    std::string text = value.text();
    if (!rule.unit.empty()) text += " " + rule.unit;
    // Items of one list of texts are one input.
    if (!inputs.empty() && inputs.back().name == place.name)
        inputs.back().value += ", " + text;
    else
        inputs.push_back({.name = place.name,
                          .profile = place.profile,
                          .origin = *origin,
                          .value = std::move(text)});
}

void walk(const Place& place, const YamlValue& value, std::vector<AttemptInput>& inputs) {
    if (!value.exists()) return;
    if (value.is_map()) {
        for (const std::string& key : value.keys())
            walk(place.member(key), value[key], inputs);
    } else if (value.is_list()) {
        const std::vector<YamlValue> items = value.list();
        for (std::size_t i = 0; i < items.size(); ++i)
            walk(place.item(items[i], i), items[i], inputs);
    } else {
        add(place, value, inputs);
    }
}

}  // namespace

std::vector<AttemptInput> inputs_of(const YamlValue& document) {
    std::vector<AttemptInput> inputs;
    for (const std::string& key : document.keys())
        walk(Place{key, key}, document[key], inputs);
    for (const FieldRule& rule : attempt_schema().fields())
        if (rule.default_value.exists() && rule.path.find('.') == std::string::npos &&
            !document[rule.path].exists())
            add(Place{rule.path, rule.path}, rule.default_value, inputs);
    bool is_second = false;
    for (AttemptInput& input : inputs)
        if (input.name.starts_with("receivers.") && input.name.ends_with(".recording") &&
            std::exchange(is_second, true))
            input.origin = {"handed_in", input.origin.changes, {}, "secondary-as-recorded"};
    return inputs;
}

}  // namespace runcert
