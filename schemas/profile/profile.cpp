#include "schemas/profile/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"
#include "files/sha256.h"
#include "schemas/common/document.h"

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

/// Whether this very text is a revision of a rule that this program, or one before it, came with.
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

/// One of the words that the field table allows.
template <class Enum>
Enum word(const YamlValue& value) {
    Enum word{};
    from_text(value.text(), word);
    return word;
}

void read_limit(const YamlValue& entry, Clause& clause) {
    clause.limit = entry["limit"].optional_real();
    clause.unit = entry["unit"].text_or("");
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

void read_accepts(const YamlValue& entry, Clause& clause) {
    if (!entry["accepts"].exists()) return;
    if (clause.decided_by != Computation::secondary_method)
        entry["accepts"].fail("only secondary_method accepts witnesses", "Remove it");
    for (const YamlValue& one : entry["accepts"].list())
        clause.accepts.push_back(one.text());
}

/// The field's own value, or its default.
YamlValue value_or_default(const YamlValue& document, std::string_view group,
                           const std::string& key) {
    const YamlValue value = document[key];
    return value.exists() ? value
                          : profile_schema().find(fmt::format("{}.{}", group, key))->default_value;
}

RoleSignatures read_answerer(const YamlValue& map) {
    constexpr std::string_view group = "clauses[].answered_by";
    return {.role = read_role(value_or_default(map, group, "role")),
            .count = value_or_default(map, group, "count").integer()};
}

std::vector<Clause> read_clauses(const YamlValue& document, const Profile& profile) {
    std::vector<Clause> clauses;
    std::set<std::string> ids;
    for (const YamlValue& entry : document["clauses"].list()) {
        Clause& clause =
            clauses.emplace_back(Clause{.id = entry["id"].text(),
                                        .text = entry["text"].text(),
                                        .source = entry["source"].text(),
                                        .certainty = word<Certainty>(entry["certainty"]),
                                        .decided_by = word<Computation>(entry["decided_by"]),
                                        .limit = std::nullopt,
                                        .unit = {}});
        read_limit(entry, clause);
        read_accepts(entry, clause);
        clause.answered_by = read_answerer(entry["answered_by"]);
        if (!ids.insert(clause.id).second)
            entry["id"].fail(
                fmt::format("two clauses have the id \"{}\"", escape_for_message(clause.id)),
                "Give each clause an id of its own");
        if (clause.decided_by == Computation::accuracy && !profile.accuracy_limit_m_s)
            entry["decided_by"].fail("the profile states no limit of accuracy",
                                     "Add accuracy: {limit, unit, coverage_factor}");
        if (clause.decided_by == Computation::opposite_runs && !profile.opposite_runs_within_s)
            entry["decided_by"].fail("the profile does not ask for two runs",
                                     "Add opposite_runs: {within_s}");
    }
    if (clauses.empty())
        document["clauses"].fail("the rule requires nothing", "List its requirements");
    return clauses;
}

Profile::Uncertainty read_uncertainty(const YamlValue& map) {
    const auto value = [&map](const char* key) {
        return value_or_default(map, "uncertainty", key);
    };
    Profile::Uncertainty uncertainty{
        .tau_min_s = value("correlation_time_min_s").real(),
        .tau_max_s = value("correlation_time_max_s").real(),
        .subtract_selection_bias = value("selection_bias").text() == "subtracted",
        .error_floor_m = {},
        .fault_probability = map["fault_probability"].optional_real()};
    if (uncertainty.tau_max_s <= uncertainty.tau_min_s) {
        const bool stated = map["correlation_time_max_s"].exists();
        map[stated ? "correlation_time_max_s" : "correlation_time_min_s"].fail(
            fmt::format("the correlation times go from {} s to {} s", uncertainty.tau_min_s,
                        uncertainty.tau_max_s),
            "Give correlation_time_max_s above correlation_time_min_s");
    }
    constexpr std::string_view floors = "uncertainty.error_floor_m";
    for (const FieldRule& rule : profile_schema().fields()) {
        if (!rule.path.starts_with(floors) || rule.path == floors) continue;
        const std::string kind = rule.path.substr(floors.size() + 1);
        uncertainty.error_floor_m[kind] =
            value_or_default(map["error_floor_m"], floors, kind).real();
    }
    return uncertainty;
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

void read_window(const YamlValue& map, Profile& profile) {
    const auto value = [&map](const char* key) { return value_or_default(map, "window", key); };
    profile.window_kind = word<WindowKind>(value("kind"));
    profile.definition = word<SpeedDefinition>(map["definition"]);
    profile.dimension = word<Dimension>(value("dimension"));
    profile.speed_source = word<SpeedSource>(value("source"));
    profile.ends = word<WindowEnds>(value("ends"));
    profile.exact_duration = value("exact").boolean();
    profile.windows = value("count").integer();
    profile.proximity_m = value("proximity_m").real();
    profile.turn_deg = value("turn_deg").real();
    profile.repaired_steps = value("repaired_steps").boolean();
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
    (by_time ? profile.duration_s : profile.distance_m) = map[length].real();
    require_sound_window(map, profile);
}

void read_runs(const YamlValue& document, Profile& profile) {
    const YamlValue map = document["runs"];
    const auto value = [&map](const char* key) {
        return value_or_default(map, "runs", key).real();
    };
    profile.runs = {.start_m_s = value("start_m_s"),
                    .stop_m_s = value("stop_m_s"),
                    .stop_s = value("stop_s"),
                    .turn_deg = value("turn_deg")};
    if (profile.runs.stop_m_s >= profile.runs.start_m_s)
        map.fail("stop_m_s is not below start_m_s", "Give stop_m_s below start_m_s");
    if (const YamlValue pair = document["opposite_runs"]; pair.exists()) {
        profile.opposite_runs_within_s = pair["within_s"].real();
        if (profile.windows != 1)
            pair.fail("the mean of two runs has one window of each", "Leave out window.count");
    }
}

void read_margin(const YamlValue& margin, Profile& profile) {
    profile.margin_kind = word<MarginKind>(margin["kind"]);
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
    profile.margin_unit = unit.text_or("");
    profile.margin =
        margin["value"].real() * (relative || time ? 1.0 : metres_per_second(profile.margin_unit));
    profile.margin_above_upper_limit =
        value_or_default(margin, "margin", "above").text() == "upper_limit";
}

std::optional<DecimalRule> read_decimals(const YamlValue& map) {
    if (!map.exists()) return std::nullopt;
    return DecimalRule{.mode = map["mode"].text(),
                       .unit = map["unit"].text(),
                       .decimals = static_cast<int>(map["decimals"].integer())};
}

}  // namespace

ClauseLimit limit_of(Computation computation) {
    if (auto units = at_most_of(computation); !units.empty()) return {true, std::move(units)};
    return {false, at_least_of(computation)};
}

std::string_view builtin_profile(std::string_view name) {
    return builtin_profile_text(std::string(name) + ".yaml");
}

std::vector<std::string> builtin_profiles() {
    std::vector<std::string> names;
    for (const std::string_view file : builtin_profile_text_names())
        names.emplace_back(file.substr(0, file.rfind('.')));
    std::ranges::sort(names);
    return names;
}

void require_own_id(const Profile& profile, const std::string& where) {
    if (profile.origin == RuleOrigin::built_in || builtin_profile(profile.id).empty()) return;
    throw Failure(where,
                  fmt::format("the id \"{}\" is that of a rule that comes with the program, and "
                              "this text (SHA-256 {}...) is no published revision of it",
                              profile.id, profile.sha256.substr(0, 16)),
                  "Claim the program's rule by its id alone; give a rule of your own another id, "
                  "and its file the same name");
}

RoleSignatures default_answerer() {
    return read_answerer(YamlValue(YamlNode(), "schemas/profile/v1.yaml"));
}

const std::vector<Clause>& own_clauses() {
    static const std::vector<Clause> clauses = [] {
        const char* const file = "own_clauses.yaml";
        const YamlValue document(parse_yaml(own_clauses_text(file), file), file);
        return read_clauses(document, Profile{});
    }();
    return clauses;
}

Profile read_profile(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, profile_schema());
    Profile profile;
    profile.id = document["id"].text();
    profile.revision = document["revision"].exists() ? document["revision"].integer() : 1;
    profile.sha256 = sha256_hex(text);
    profile.origin = is_published(profile) ? RuleOrigin::built_in : RuleOrigin::own;
    profile.body = document["body"].text();
    profile.title = document["title"].text();
    read_window(document["window"], profile);
    read_runs(document, profile);
    if (const YamlValue accuracy = document["accuracy"]; accuracy.exists()) {
        profile.accuracy_unit = accuracy["unit"].text();
        profile.accuracy_limit_m_s =
            accuracy["limit"].real() * metres_per_second(profile.accuracy_unit);
        profile.coverage_factor = accuracy["coverage_factor"].real();
    }
    read_margin(document["margin"], profile);
    profile.rounding = read_decimals(document["rounding"]);
    profile.result = read_decimals(document["result"]);
    profile.decision_probability =
        value_or_default(document["decision"], "decision", "probability").real();
    profile.subtract_current =
        (document["current"].exists() ? document["current"]
                                      : profile_schema().find("current")->default_value)
            .text() == "subtracted";
    if (profile.subtract_current && (profile.windows > 1 || profile.opposite_runs_within_s))
        document["current"].fail(
            "the current is known along one window, and the rule takes several",
            "Leave out current, or take one window");
    profile.signatures = read_role_signatures(document["signatures"]);
    profile.uncertainty = read_uncertainty(document["uncertainty"]);
    profile.clauses = read_clauses(document, profile);
    for (const YamlValue& clause : document["clauses"].list())
        if (clause["decided_by"].text() == to_text(Computation::claims))
            clause["decided_by"].fail("claims is what this program asks beside every rule",
                                      "Write attest: an official answers for the clause");
    return profile;
}

}  // namespace runcert
