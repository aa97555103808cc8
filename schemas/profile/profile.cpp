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
#include "schemas/profile/extends.h"
#include "store/sha256.h"
#include "store/yaml_output.h"

namespace runcert {

YamlNode profile_field_table_node();
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

bool needs_part(Computation computation) {
    return computation == Computation::counted_part || computation == Computation::start_height ||
           computation == Computation::validation_accuracy;
}

void require_sound_clauses(const YamlValue& list, const Profile& profile) {
    std::set<std::string> ids;
    const std::vector<YamlValue> entries = list.list();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const YamlValue& entry = entries[i];
        const Clause& clause = profile.clauses[i];
        require_limit(entry, clause);
        if (entry["accepts"].exists() && clause.decided_by != Computation::secondary_method)
            entry["accepts"].fail("only secondary_method accepts witnesses", "Remove it");
        if (const YamlValue role = entry["answered_by"]["role"]; role.exists())
            (void)read_role(role);
        if (!ids.insert(clause.id).second)
            entry["id"].fail(
                fmt::format("two clauses have the id \"{}\"", escape_for_message(clause.id)),
                "Give each clause an id of its own");
        if (clause.decided_by == Computation::accuracy && !profile.accuracy_limit_m_s)
            entry["decided_by"].fail("the profile states no limit of accuracy",
                                     "Add accuracy: {limit, unit, coverage_factor}");
        if (needs_part(clause.decided_by) && !profile.within)
            entry["decided_by"].fail("the rule counts all of the recording",
                                     "Add window: {within: {from, to}}");
        if (clause.decided_by == Computation::validation_accuracy && profile.within &&
            !profile.within->validation_m)
            entry["decided_by"].fail("the rule validates no part of its samples",
                                     "Add window: {within: {validation_m}}");
        if (clause.decided_by == Computation::opposite_runs && !profile.opposite_runs_within_s)
            entry["decided_by"].fail("the profile does not ask for two runs",
                                     "Add opposite_runs: {within_s}");
    }
    if (profile.clauses.empty()) list.fail("the rule requires nothing", "List its requirements");
}

/// A question has an id of its own, also beside the clauses: readers name both alike.
void require_sound_questions(const YamlValue& list, const Profile& profile) {
    std::set<std::string> ids;
    for (const Clause& clause : profile.clauses)
        ids.insert(clause.id);
    for (std::size_t i = 0; i < profile.questions.size(); ++i)
        if (!ids.insert(profile.questions[i].id).second)
            list.list()[i]["id"].fail(fmt::format("another question or clause has the id \"{}\"",
                                                  escape_for_message(profile.questions[i].id)),
                                      "Give each an id of its own");
}

/// What measures nothing has no figure, and nothing that a recording decides.
void require_sound_evidence(const YamlValue& document) {
    for (const char* const key : {"window", "runs", "opposite_runs", "accuracy", "margin",
                                  "rounding", "result", "decision", "current", "uncertainty"})
        if (document[key].exists())
            document[key].fail("a rule of evidence measures nothing", "Remove it");
    for (const YamlValue& clause : document["clauses"].list())
        if (clause["decided_by"].text() != to_text(Computation::attest))
            clause["decided_by"].fail("a rule of evidence measures nothing that could decide it",
                                      "Write attest: an official answers for the clause");
}

/// What every rule has that measures something.
void require_measure(const YamlValue& document) {
    for (const auto& [key, remedy] :
         {std::pair{"window", "Add window: {duration_s, definition}, or another kind of window"},
          {"margin", "Add margin: {kind, value, unit}; value: 0 where any higher speed counts"}})
        if (!document[key].exists())
            document.fail(fmt::format("the key \"{}\" is missing ({})", key,
                                      profile_schema().find(key)->description),
                          remedy);
}

/// What the rule leaves out has its default.
void complete_floors(ErrorFloors& floors) {
    constexpr std::string_view path = "uncertainty.error_floor_m.";
    for (const FieldRule& rule : profile_schema().fields())
        if (rule.path.starts_with(path))
            floors.try_emplace(rule.path.substr(path.size()), rule.default_value.real());
}

void require_correlation_times(const YamlValue& map, const UncertaintyRule& uncertainty) {
    if (uncertainty.tau_max_s > uncertainty.tau_min_s) return;
    const bool stated = map["correlation_time_max_s"].exists();
    map[stated ? "correlation_time_max_s" : "correlation_time_min_s"].fail(
        fmt::format("the correlation times go from {} s to {} s", uncertainty.tau_min_s,
                    uncertainty.tau_max_s),
        "Give correlation_time_max_s above correlation_time_min_s");
}

/// Combinations that no computation exists for.
void require_sound_window(const YamlValue& map, const Profile& profile) {
    const bool course = profile.window_kind == WindowKind::course;
    const bool chord = profile.definition == SpeedDefinition::displacement;
    const bool mean = profile.definition == SpeedDefinition::mean_n ||
                      profile.definition == SpeedDefinition::mean_n_plus_1;
    if (course != (profile.definition == SpeedDefinition::elapsed_time))
        map["definition"].fail(
            course ? "over a course the speed is its length over the elapsed time"
                   : "elapsed_time is the speed over a course",
            course ? "Write definition: elapsed_time" : "Give kind: course, or another definition");
    if (course && (profile.dimension != Dimension::horizontal ||
                   profile.speed_source != SpeedSource::position))
        map["kind"].fail("the lines of a course are crossed horizontally, by positions",
                         "Leave out dimension and source");
    if (profile.speed_source == SpeedSource::velocity && (chord || profile.ends == WindowEnds::any))
        map["source"].fail(
            "recorded velocities are known at the measured epochs only, and tell a "
            "mean or a path",
            "Use definition: mean_n_plus_1, mean_n or path_length, and ends: epochs");
    if (profile.ends == WindowEnds::any && mean)
        map["ends"].fail("a mean of the speeds of epochs begins and ends at epochs",
                         "Use ends: epochs, or definition: displacement or path_length");
    if (profile.dimension == Dimension::space && profile.speed_source == SpeedSource::position &&
        !chord)
        map["dimension"].fail("speed in space is computed by displacement over time only",
                              "Use definition: displacement");
    if (profile.window_kind == WindowKind::alpha &&
        (profile.definition != SpeedDefinition::path_length || profile.ends == WindowEnds::any ||
         profile.dimension != Dimension::horizontal))
        map["kind"].fail("an alpha is a horizontal path between measured epochs",
                         "Use definition: path_length, ends: epochs, dimension: horizontal");
    if (profile.window_kind == WindowKind::distance &&
        (mean || (profile.ends == WindowEnds::any && chord)))
        map["definition"].fail(
            "a distance is reached along the path, or by the straight line "
            "between measured epochs",
            "Use definition: path_length, or displacement with ends: epochs");
    if (profile.exact_duration &&
        (profile.window_kind != WindowKind::time || profile.ends == WindowEnds::any))
        map["exact"].fail("only windows of kind time between measured epochs can be exact",
                          "Remove it");
}

void require_length(const YamlValue& map, const Profile& profile) {
    const bool by_time = profile.window_kind == WindowKind::time;
    const char* const length = by_time ? "duration_s" : "distance_m";
    const char* const other = by_time ? "distance_m" : "duration_s";
    if (!map[length].exists())
        map.fail(fmt::format("a window of kind {} needs its length", to_text(profile.window_kind)),
                 fmt::format("Add {}:", length));
    if (map[other].exists())
        map[other].fail(
            fmt::format("a window of kind {} has no {}", to_text(profile.window_kind), other),
            "Remove it");
}

/// A part of the recording has ends that can be found, and windows that can lie in it.
void require_sound_part(const YamlValue& within, const Profile& profile) {
    if (!profile.within) return;
    if (profile.window_kind == WindowKind::course)
        within.fail("the lines of a course say where its window lies", "Remove within");
    const auto needs_height = [](WindowEvent event) {
        return event == WindowEvent::below_start || event == WindowEvent::above_ground ||
               event == WindowEvent::at_height;
    };
    const auto require_end = [&](const YamlValue& map, const PartEnd& end) {
        if (needs_height(end.event) != end.height_m.has_value())
            map[end.height_m ? "height_m" : "event"].fail(
                fmt::format("{} {} a height", to_text(end.event),
                            end.height_m ? "has not" : "needs"),
                end.height_m ? "Remove it" : "Add height_m:");
        if (end.event != WindowEvent::exit && map["speed_m_s"].exists())
            map["speed_m_s"].fail(fmt::format("{} has no speed", to_text(end.event)), "Remove it");
    };
    require_end(within["from"], profile.within->from);
    if (profile.within->from.event == WindowEvent::below_start)
        within["from"]["event"].fail("the part cannot begin below its own beginning",
                                     "Write another event");
    const std::vector<YamlValue> ends = within["to"].list();
    if (ends.empty()) within["to"].fail("the part has no end", "List the events that end it");
    for (std::size_t i = 0; i < ends.size(); ++i)
        require_end(ends[i], profile.within->to[i]);
}

/// The body's arithmetic is one that recorded samples allow.
void require_sound_arithmetic(const YamlValue& map, const Profile& profile) {
    if (!profile.arithmetic) return;
    Profile as_recorded = profile;
    as_recorded.speed_source = profile.arithmetic->source;
    as_recorded.definition = profile.arithmetic->definition;
    require_sound_window(map, as_recorded);
}

void require_sound_runs(const YamlValue& document, const Profile& profile) {
    if (profile.runs.stop_m_s >= profile.runs.start_m_s)
        document["runs"].fail("stop_m_s is not below start_m_s", "Give stop_m_s below start_m_s");
    if (profile.opposite_runs_within_s && profile.windows != 1)
        document["opposite_runs"].fail("the mean of two runs has one window of each",
                                       "Leave out window.count");
}

void require_sound_margin(const YamlValue& margin, const Profile& profile) {
    const YamlValue unit = margin["unit"];
    const bool relative = profile.margin_kind == MarginKind::relative;
    const bool time = profile.margin_kind == MarginKind::elapsed_time;
    if (!relative && !unit.exists())
        margin.fail(time ? "a margin of time needs a unit" : "an absolute margin needs a unit",
                    time ? "Add unit: s" : "Add unit: km/h, m/s, kn or mph");
    if (relative && unit.exists()) unit.fail("a relative margin has no unit", "Remove it");
    if (unit.exists() && time != (unit.text() == "s"))
        unit.fail(fmt::format("\"{}\" is not a unit of this kind of margin", unit.text()),
                  time ? "Write unit: s" : "Use km/h, m/s, kn or mph");
    if (time && profile.window_kind != WindowKind::course)
        margin["kind"].fail("a margin of time belongs to a course", "Use absolute or relative");
}

/// What every rule has that measures something, and combinations of it that make sense.
void require_sound_measure(const YamlValue& document, const Profile& profile) {
    require_measure(document);
    require_length(document["window"], profile);
    require_sound_window(document["window"], profile);
    require_sound_part(document["window"]["within"], profile);
    require_sound_arithmetic(document["arithmetic"], profile);
    require_sound_runs(document, profile);
    require_sound_margin(document["margin"], profile);
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
        Profile rule;
        for (const YamlValue& entry : document["clauses"].list())
            rule.clauses.push_back(read_members<Clause>(entry));
        require_sound_clauses(document["clauses"], rule);
        return std::move(rule.clauses);
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
    if (profile.evidence)
        require_sound_evidence(document);
    else
        require_sound_measure(document, profile);
    if (profile.accuracy_limit)
        profile.accuracy_limit_m_s =
            *profile.accuracy_limit * metres_per_second(profile.accuracy_unit);
    profile.margin =
        profile.margin_value * (!profile.evidence && profile.margin_kind == MarginKind::absolute
                                    ? metres_per_second(profile.margin_unit)
                                    : 1.0);
    if (profile.speed_of == SpeedOf::reference_point &&
        profile.speed_source == SpeedSource::velocity)
        document["speed_of"].fail(
            "recorded velocities are those of the antenna",
            "Take the speed from positions (window: {source: position}), or leave out speed_of");
    if (profile.current == CurrentUse::subtracted &&
        (profile.windows > 1 || profile.opposite_runs_within_s))
        document["current"].fail(
            "the current is known along one window, and the rule takes several",
            "Leave out current, or take one window");
    profile.signatures = read_role_signatures(document["signatures"]);
    require_correlation_times(document["uncertainty"], profile.uncertainty);
    complete_floors(profile.uncertainty.error_floor_m);
    require_sound_clauses(document["clauses"], profile);
    require_sound_questions(document["questions"], profile);
    for (const YamlValue& clause : document["clauses"].list())
        if (clause["decided_by"].text() == to_text(Computation::claims))
            clause["decided_by"].fail("claims is what this program asks beside every rule",
                                      "Write attest: an official answers for the clause");
    return profile;
}

}  // namespace runcert
