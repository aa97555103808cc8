#include "schemas/profile/profile.h"

#include <fmt/format.h>

#include <set>

#include "core/failure.h"
#include "core/text.h"

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
    if (!document["schema"].exists() || document["schema"].text() != "profile/1.0")
        document.fail("this is not a profile", "A profile begins with \"schema: profile/1.0\"");
    profile_schema().validate(document);
    Profile profile;
    profile.id = document["id"].text();
    profile.body = document["body"].text();
    profile.title = document["title"].text();
    profile.duration_s = document["window"]["duration_s"].real();
    profile.definition = document["window"]["definition"].text();
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
    profile.clauses = read_clauses(document, profile);
    return profile;
}

}  // namespace runcert
