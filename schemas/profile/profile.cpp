#include "schemas/profile/profile.h"

#include <fmt/format.h>

#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/revision.h"

namespace runcert {

std::string_view profile_schema_text(std::string_view name);
std::string_view builtin_profile_text(std::string_view name);

namespace {

const DocumentSchema& profile_schema() {
    static const DocumentSchema schema =
        DocumentSchema::parse(profile_schema_text("v1.yaml"), "schemas/profile/v1.yaml");
    return schema;
}

std::vector<Clause> read_clauses(const YamlValue& document, const Profile& profile) {
    std::vector<Clause> clauses;
    std::set<std::string> ids;
    for (const YamlValue& entry : document["clauses"].list()) {
        const Clause& clause =
            clauses.emplace_back(Clause{.id = entry["id"].text(),
                                        .text = entry["text"].text(),
                                        .source = entry["source"].text(),
                                        .certainty = entry["certainty"].text(),
                                        .decided_by = entry["decided_by"].text()});
        if (!ids.insert(clause.id).second)
            entry["id"].fail(
                fmt::format("two clauses have the id \"{}\"", escape_for_message(clause.id)),
                "Give each clause an id of its own");
        if (clause.decided_by == "accuracy" && !profile.accuracy_limit_mps)
            entry["decided_by"].fail("the profile states no limit of accuracy",
                                     "Add accuracy: {limit, unit, coverage_factor}");
    }
    if (clauses.empty())
        document["clauses"].fail("the rule requires nothing", "List its requirements");
    return clauses;
}

/// The field's own value, or its default.
YamlValue value_or_default(const YamlValue& document, std::string_view group,
                           const std::string& key) {
    const YamlValue value = document[key];
    return value.exists() ? value
                          : profile_schema().find(fmt::format("{}.{}", group, key))->default_value;
}

Profile::Uncertainty read_uncertainty(const YamlValue& map) {
    const auto value = [&map](const char* key) {
        return value_or_default(map, "uncertainty", key);
    };
    Profile::Uncertainty uncertainty{
        .tau_min_s = value("correlation_time_min_s").real(),
        .tau_max_s = value("correlation_time_max_s").real(),
        .subtract_selection_bias = value("selection_bias").text() == "subtracted",
        .error_floor_m = {}};
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

}  // namespace

double metres_per_second(std::string_view unit) {
    if (unit == "m/s") return 1.0;
    if (unit == "km/h") return 1000.0 / 3600.0;
    if (unit == "kn") return 1852.0 / 3600.0;
    if (unit == "mph") return 1609.344 / 3600.0;
    throw Failure("unit", fmt::format("\"{}\" is not a unit of speed", escape_for_message(unit)),
                  "Use km/h, m/s, kn or mph");
}

std::string_view builtin_profile(std::string_view name) {
    return builtin_profile_text(std::string(name) + ".yaml");
}

Profile read_profile(std::string_view text, const std::string& where) {
    const YamlValue document(parse_yaml(text, where), where);
    const std::optional<std::int64_t> revision = written_revision(document, profile_schema());
    if (!revision)
        document.fail("this is not a profile, or not one of " + known_revisions(profile_schema()),
                      "A profile begins with \"schema: profile/1.2\"");
    validate_revision(document, profile_schema(), *revision);
    Profile profile;
    profile.id = document["id"].text();
    profile.body = document["body"].text();
    profile.title = document["title"].text();
    profile.duration_s = document["window"]["duration_s"].real();
    profile.definition = document["window"]["definition"].text();
    profile.repaired_steps =
        value_or_default(document["window"], "window", "repaired_steps").boolean();
    if (const YamlValue accuracy = document["accuracy"]; accuracy.exists()) {
        profile.accuracy_unit = accuracy["unit"].text();
        profile.accuracy_limit_mps =
            accuracy["limit"].real() * metres_per_second(profile.accuracy_unit);
        profile.coverage_factor = accuracy["coverage_factor"].real();
    }
    const YamlValue margin = document["margin"];
    profile.margin_is_relative = margin["kind"].text() == "relative";
    if (!profile.margin_is_relative && !margin["unit"].exists())
        margin.fail("an absolute margin needs a unit", "Add unit: km/h, m/s, kn or mph");
    if (profile.margin_is_relative && margin["unit"].exists())
        margin["unit"].fail("a relative margin has no unit", "Remove it");
    profile.margin = margin["value"].real() *
                     (profile.margin_is_relative ? 1.0 : metres_per_second(margin["unit"].text()));
    if (const YamlValue rounding = document["rounding"]; rounding.exists())
        profile.rounding = {.mode = rounding["mode"].text(),
                            .unit = rounding["unit"].text(),
                            .decimals = static_cast<int>(rounding["decimals"].integer())};
    profile.uncertainty = read_uncertainty(document["uncertainty"]);
    profile.clauses = read_clauses(document, profile);
    return profile;
}

}  // namespace runcert
