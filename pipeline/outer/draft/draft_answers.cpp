#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "core/written_unit.h"
#include "draft/draft.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/recognition/proposed.h"
#include "store/yaml_output.h"

// What a person answers, put into an attempt.

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* answer = "the answer";

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Failure(answer, what, remedy);
}

std::vector<std::string> parted(std::string_view text, char separator = ',') {
    std::vector<std::string> parts;
    while (true) {
        const std::size_t comma = std::min(text.find(separator), text.size());
        if (const std::string_view part = trim(text.substr(0, comma)); !part.empty())
            parts.emplace_back(part);
        if (comma == text.size()) return parts;
        text.remove_prefix(comma + 1);
    }
}

/// A name as people write it, as the program spells it: "Land yacht" is land-yacht.
std::string spelled(std::string_view text) {
    std::string name = lower_case(trim(text));
    std::ranges::replace_if(
        name, [](char c) { return c == ' ' || c == '_'; }, '-');
    return name;
}

/// "202.9 km/h", "110 knots".
Json record_of(std::string_view text) {
    text = trim(text);
    const std::size_t end = std::min(text.find_first_not_of("0123456789.,+-"), text.size());
    const std::string_view number = trim(text.substr(0, end));
    const auto unit = find_unit(text.substr(end), Quantity::speed);
    const std::vector<std::string>& units = attempt_schema().find("record.unit")->values;
    if (!unit || std::ranges::find(units, unit->name) == units.end())
        refuse(fmt::format("\"{}\" names no unit of speeds behind its number",
                           escape_for_message(text)),
               fmt::format("Write it as 202.9 km/h; units are {}", fmt::join(units, ", ")));
    // As every number of an attempt, with the words for what is wrong with it.
    const double speed = YamlValue(parse_yaml(number, answer), answer).real();
    // A craft on the ground has run at 1,228 km/h, a skydiver has fallen at 1,358.
    constexpr double slowest_m_s = 0.3, fastest_m_s = 400.0;
    const double m_s = speed * unit->factor;
    if (!(m_s >= slowest_m_s && m_s <= fastest_m_s))
        refuse(fmt::format("{} is no speed that a craft has a record of", escape_for_message(text)),
               "Check the number and its unit");
    return {{"speed", speed}, {"unit", std::string(unit->name)}};
}

/// "measurer Ann Lee, judge"; or with semicolons between them, so that a name may hold a comma.
Json officials_of(std::string_view text) {
    Json officials = Json::array();
    const char separator = text.find(';') == std::string_view::npos ? ',' : ';';
    for (const std::string& one : parted(text, separator)) {
        const std::size_t blank = std::min(one.find(' '), one.size());
        Json official{{"role", lower_case(one.substr(0, blank))}};
        if (blank < one.size()) official["name"] = std::string(trim(one.substr(blank)));
        officials.push_back(std::move(official));
    }
    if (officials.empty()) refuse("it names nobody", "Write role and name: measurer Ann Lee");
    return officials;
}

Json profiles_of(std::string_view text) {
    Json profiles = Json::array();
    const std::vector<std::string> known = builtin_profiles();
    for (const std::string& typed : parted(text)) {
        const std::string one = typed.ends_with(".yaml") ? typed : spelled(typed);
        if (claimed_by(one).size() == 1 && builtin_profile(one).empty() &&
            !one.ends_with(".yaml")) {
            const std::vector<std::string_view> names(known.begin(), known.end());
            refuse(
                fmt::format("there is no rule \"{}\"", escape_for_message(one)),
                fmt::format("Did you mean {}? `runcert explain --profiles` lists them; a rule of "
                            "your own is a file that ends in .yaml",
                            nearest(one, names)));
        }
        profiles.push_back(one);
    }
    return profiles;
}

Json value_of(const FieldRule& rule, const std::string& text);

/// Of a map whose keys are all required as many words: "0 0 -5" of an arm, "55 south" of a grid.
std::optional<Json> parts_of(const FieldRule& map, const std::string& text) {
    std::vector<const FieldRule*> fields;
    for (const FieldRule& rule : attempt_schema().fields())
        if (rule.path.starts_with(map.path + ".") && rule.required &&
            rule.path.find('.', map.path.size() + 1) == std::string::npos)
            fields.push_back(&rule);
    const auto name_of = [&](const FieldRule* rule) {
        return rule->path.substr(map.path.size() + 1);
    };
    if (fields.size() == 1) {
        const auto only = parts_of(*fields.front(), text);
        return only ? std::optional(Json{{name_of(fields.front()), *only}}) : std::nullopt;
    }
    std::vector<std::string> parts;
    for (const std::string& part : parted(text))
        std::ranges::copy(parted(part, ' '), std::back_inserter(parts));
    if (fields.empty() || parts.size() != fields.size()) return std::nullopt;
    Json made = Json::object();
    for (std::size_t i = 0; i < parts.size(); ++i)
        made[name_of(fields[i])] = value_of(*fields[i], parts[i]);
    return made;
}

/// A value as its field wants it: text as it is typed, else as YAML reads it.
Json value_of(const FieldRule& rule, const std::string& text) {
    const auto is_a = [&](const char* type) { return std::ranges::count(rule.types, type) > 0; };
    const std::string_view trimmed = trim(text);
    if (std::ranges::count(rule.values, spelled(text)) > 0) return spelled(text);
    const bool structured = trimmed.starts_with('{') || trimmed.starts_with('[');
    if (is_a("map") && !structured)
        if (auto made = parts_of(rule, text)) return *made;
    if (!structured && is_a("list")) {
        const std::vector<std::string> parts = parted(text);
        if (is_a("text") && parts.size() == 1) return parts.front();
        return parts;
    }
    if (is_a("integer") && is_a("text"))
        if (const auto number = parse_integer(trimmed)) return *number;
    if (is_a("text") && !structured) return std::string(trimmed);
    const YamlNode node = parse_yaml(trimmed, answer);
    if (is_a("real") && !structured) (void)YamlValue(node, answer).real();
    return json_from_yaml(YamlValue(node, answer));
}

/// The key as the attempt has it: of a receiver's alone, the primary one's.
std::string whole_key(const std::string& key) {
    const std::string first = key.substr(0, key.find('.'));
    if (attempt_schema().find(first)) return key;
    if (attempt_schema().find("receivers[]." + first)) return "receivers.primary." + key;
    std::vector<std::string_view> known;
    for (const FieldRule& rule : attempt_schema().fields())
        if (rule.path.find("[]") == std::string::npos) known.push_back(rule.path);
    throw Failure(escape_for_message(key), "an attempt has no such key",
                  fmt::format("Did you mean \"{}\"? `runcert certify --help` lists all",
                              nearest(key, known)));
}

}  // namespace

void Draft::set_date_of_superseded() {
    constexpr std::size_t date_length = 10;
    if (keys_.contains("date") || !files_.front().is.first) return;
    for (const Json& one : keys_["profiles"]) {
        const std::string_view text = builtin_profile(one.get<std::string>());
        if (!text.empty() && !read_profile(text, "rule").superseded_by.empty())
            keys_["date"] = to_utc_iso(*files_.front().is.first, 0).substr(0, date_length);
    }
}

void Draft::set_record(const std::string& path, const std::string& text) {
    const std::string profile = path.substr(0, path.find('.'));
    if (std::ranges::count(profiles(), profile) == 0)
        refuse(
            fmt::format("the attempt does not claim the rule \"{}\"", escape_for_message(profile)),
            "Add it to profiles first");
    Json& records = keys_["records"];
    if (records.is_null()) records = Json::array();
    auto found =
        std::ranges::find_if(records, [&](const Json& one) { return one["profile"] == profile; });
    if (path.ends_with(".source")) {
        if (found == records.end()) refuse("its record is not stated", "State it first");
        (*found)["source"] = std::string(trim(text));
        return;
    }
    const Json record = record_of(text);
    if (found == records.end()) {
        records.push_back({{"profile", profile}});
        found = std::prev(records.end());
    }
    found->update(record);
}

void Draft::set(const std::string& given, const std::string& text) {
    const std::string key = whole_key(given);
    const Json before = keys_;
    const auto take = [&] {
        if (key == "record.speed") {
            keys_["record"].update(record_of(text));
        } else if (key.starts_with("records.")) {
            set_record(key.substr(key.find('.') + 1), text);
        } else if (key == "officials") {
            keys_["officials"] = officials_of(text);
        } else if (key == "profiles") {
            keys_["profiles"] = profiles_of(text);
            set_date_of_superseded();
        } else if (key.starts_with("receivers.")) {
            const std::string rest = key.substr(key.find('.') + 1);
            const std::size_t point = rest.find('.');
            Json* const receiver = find_receiver(rest.substr(0, point));
            const std::string path = point == std::string::npos ? "" : rest.substr(point + 1);
            const FieldRule* rule = attempt_schema().find("receivers[]." + path);
            if (!receiver || !rule)
                throw Failure(
                    escape_for_message(given), "no receiver of the attempt has such a key",
                    "Write receivers.primary.KEY; `runcert certify --help` lists the keys");
            put_at(*receiver, path, value_of(*rule, text));
            if (path.starts_with("columns.")) (*receiver)["format"] = "csv";
        } else {
            const FieldRule* rule = attempt_schema().find(key);
            if (!rule)
                throw Failure(escape_for_message(given), "an attempt has no such key",
                              "`runcert certify --help` lists all");
            put_at(keys_, key, value_of(*rule, text));
        }
        Json attempt{{"schema", attempt_schema().name() + "/" + attempt_schema().version()}};
        attempt.update(keys_);
        (void)read_attempt(to_yaml_text(attempt), answer, Completeness::begun);
    };
    try {
        take();
    } catch (const Failure&) {
        keys_ = before;
        throw;
    }
}

}  // namespace runcert
