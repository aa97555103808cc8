#include "schemas/profile/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/document.h"
#include "store/sha256.h"
#include "store/yaml_output.h"

namespace runcert {

YamlNode profile_field_table_node();
YamlValue extended(const YamlValue& document);
std::string_view builtin_profile_text(std::string_view name);
std::string_view own_clauses_text(std::string_view name);
std::string_view published_rules_text(std::string_view name);
std::vector<std::string_view> builtin_profile_text_names();

const DocumentSchema& profile_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(profile_field_table_node(), "schemas/profile/v1.yaml");
    return schema;
}

namespace {

/// Whether this very text is that of a rule that comes with the program.
bool is_published(const Profile& profile) {
    static const std::set<std::string> lines = [] {
        std::istringstream table{std::string(published_rules_text("published_rules.txt"))};
        std::set<std::string> all;
        for (std::string line; std::getline(table, line);)
            if (!line.starts_with('#')) all.insert(line);
        return all;
    }();
    return lines.contains(fmt::format("{}  {} {}", profile.sha256, profile.id, profile.revision));
}

void require_limit(const YamlValue& entry, const Clause& clause) {
    const std::string_view computation = to_text(clause.decided_by);
    const std::vector<std::string_view> known = limit_of(clause.decided_by).units;
    if (known.empty()) {
        if (clause.limit || !clause.unit.empty())
            entry[clause.limit ? "limit" : "unit"].fail(
                fmt::format("{} compares with no limit", computation), "Remove it");
        return;
    }
    const std::string units = fmt::format("{}", fmt::join(known, ", "));
    if (!clause.limit)
        entry["decided_by"].fail(fmt::format("{} needs a figure to compare with", computation),
                                 "Add limit: and unit: (" + units + ")");
    if (std::ranges::find(known, clause.unit) == known.end())
        (clause.unit.empty() ? entry["limit"] : entry["unit"])
            .fail(clause.unit.empty()
                      ? std::string("the limit has no unit")
                      : fmt::format("{} is not compared in \"{}\"", computation, clause.unit),
                  "Give unit: " + units);
}

void require_limits(const YamlValue& list, const std::vector<Clause>& clauses) {
    for (std::size_t i = 0; i < clauses.size(); ++i)
        require_limit(list.list()[i], clauses[i]);
}

/// What the rule leaves out has its default.
void complete_floors(ErrorFloors& floors) {
    constexpr std::string_view path = "uncertainty.error_floor_m.";
    for (const FieldRule& rule : profile_schema().fields())
        if (rule.path.starts_with(path))
            floors.try_emplace(rule.path.substr(path.size()), rule.default_value.real());
}

}  // namespace

ClauseLimit limit_of(Computation computation) {
    if (auto units = at_most_of(computation); !units.empty()) return {true, std::move(units)};
    return {false, at_least_of(computation)};
}

std::string_view builtin_profile(std::string_view name) {
    static std::mutex mutex;
    static std::map<std::string, std::string> resolved;
    const std::string file = std::string(name) + ".yaml";
    const std::string_view text = builtin_profile_text(file);
    if (text.empty()) return {};
    const std::lock_guard lock(mutex);
    const auto known = resolved.find(file);
    return known != resolved.end()
               ? known->second
               : resolved.emplace(file, resolved_profile(text, file)).first->second;
}

std::string resolved_profile(std::string_view text, const std::string& where) {
    const YamlValue document(parse_yaml(text, where), where);
    if (!document.is_map() || !document["extends"].exists()) return std::string(text);
    return plain_yaml_text(read_profile(text, where).written.node());
}

std::vector<std::string> builtin_profiles() {
    std::vector<std::string> names;
    for (const std::string_view file : builtin_profile_text_names())
        names.emplace_back(file.substr(0, file.rfind('.')));
    std::ranges::sort(names);
    return names;
}

void require_own_id(const Profile& profile, const std::string& where) {
    if (profile.origin == RuleOrigin::built_in || builtin_profile(lower_case(profile.id)).empty())
        return;
    throw Failure(where,
                  fmt::format("the id \"{}\" is that of a rule that comes with the program, and "
                              "this text (SHA-256 {}...) is not that rule's",
                              profile.id, profile.sha256.substr(0, 16)),
                  "Claim the program's rule by its id alone; give a rule of your own another id, "
                  "and its file the same name");
}

const std::vector<Clause>& own_clauses() {
    static const std::vector<Clause> clauses = [] {
        const char* const file = "own_clauses.yaml";
        const YamlValue document(parse_yaml(own_clauses_text(file), file), file);
        std::vector<Clause> all;
        for (const YamlValue& entry : document["clauses"].list())
            all.push_back(read_members<Clause>(entry));
        require_limits(document["clauses"], all);
        return all;
    }();
    return clauses;
}

template <>
ErrorFloors read_members(const YamlValue& map) {
    ErrorFloors floors;
    for (const std::string& kind : map.keys())
        floors[kind] = map[kind].real();
    return floors;
}

Profile read_profile(std::string_view text, const std::string& where) {
    const YamlValue as_written = parse_input(text, where, profile_schema());
    const YamlValue document = extended(as_written);
    profile_schema().validate(document);
    Profile profile{read_members<ProfileDocument>(document)};
    profile.sha256 = sha256_hex(as_written["extends"].exists() ? plain_yaml_text(document.node())
                                                               : std::string(text));
    profile.written = document;
    profile.origin = is_published(profile) ? RuleOrigin::built_in : RuleOrigin::own;
    if (profile.accuracy_limit)
        profile.accuracy_limit_m_s =
            *profile.accuracy_limit * metres_per_second(profile.accuracy_unit);
    profile.margin =
        profile.margin_value * (!profile.evidence && profile.margin_kind == MarginKind::absolute
                                    ? metres_per_second(profile.margin_unit)
                                    : 1.0);
    complete_floors(profile.uncertainty.error_floor_m);
    require_limits(document["clauses"], profile.clauses);
    return profile;
}

}  // namespace runcert
