#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/profile/profile.h"

namespace runcert {
namespace {

/// A figure of a profile that an attempt may replace.
struct Figure {
    std::string name;
    double* value;
    std::string unit;
    double per_unit;         ///< of the value, for one of `unit`
    const FieldRule* field;  ///< that bounds it, both ends allowed
};

std::vector<Figure> figures_of(Profile& profile) {
    std::vector<Figure> figures;
    const auto add = [&](const std::string& path, double& value, const std::string& unit = {},
                         double per_unit = 1.0) {
        const FieldRule* field = profile_schema().find(path);
        figures.push_back({path, &value, field->unit + unit, per_unit, field});
    };
    if (profile.window_kind == WindowKind::time)
        add("window.duration_s", profile.duration_s);
    else
        add("window.distance_m", profile.distance_m);
    add("margin.value", profile.margin, profile.margin_unit,
        profile.margin_kind == MarginKind::absolute ? metres_per_second(profile.margin_unit) : 1.0);
    if (profile.accuracy_limit_m_s) {
        add("accuracy.limit", *profile.accuracy_limit_m_s, profile.accuracy_unit,
            metres_per_second(profile.accuracy_unit));
        add("accuracy.coverage_factor", profile.coverage_factor);
    }
    add("decision.probability", profile.decision_probability);
    if (profile.opposite_runs_within_s)
        add("opposite_runs.within_s", *profile.opposite_runs_within_s);
    for (Clause& clause : profile.clauses)
        if (clause.limit) {
            add("clauses[].limit", *clause.limit, clause.unit);
            figures.back().name = "clauses." + clause.id + ".limit";
        }
    return figures;
}

}  // namespace

std::string window_words(const Profile& profile) {
    if (profile.window_kind == WindowKind::time) return fmt::format("{:g} s", profile.duration_s);
    if (profile.window_kind == WindowKind::course)
        return fmt::format("a course of {:g} m", profile.distance_m);
    if (profile.window_kind == WindowKind::alpha)
        return fmt::format("an alpha of {:g} m", profile.distance_m);
    return fmt::format("{:g} m", profile.distance_m);
}

std::string rule_unit_name(const Profile& profile) {
    if (profile.result) return profile.result->unit;
    if (profile.rounding) return profile.rounding->unit;
    return profile.accuracy_unit.empty() ? "km/h" : profile.accuracy_unit;
}

void override_figure(Profile& profile, FigureOverride figure) {
    const std::vector<Figure> known = figures_of(profile);
    const auto one = std::ranges::find(known, figure.figure, &Figure::name);
    if (one == known.end()) {
        std::vector<std::string> names;
        for (const Figure& each : known)
            names.push_back(each.name);
        throw Failure(figure.place,
                      fmt::format("the profile {} has no figure \"{}\"", profile.id,
                                  escape_for_message(figure.figure)),
                      fmt::format("Use one of: {}", fmt::join(names, ", ")));
    }
    constexpr double largest = 1e9;
    const Figure& found = *one;
    const double used = figure.used;
    const double least = found.field->minimum.value_or(-largest);
    const double most = found.field->maximum.value_or(largest);
    if (!(used >= least && used <= most))
        throw Failure(figure.place,
                      fmt::format("{} cannot be {:g}{}{}", figure.figure, used,
                                  found.unit.empty() ? "" : " ", found.unit),
                      fmt::format("Give a figure from {:g} to {:g}", least, most));
    figure.rule = *found.value / found.per_unit;
    figure.unit = found.unit;
    *found.value = used * found.per_unit;
    profile.overrides.push_back(std::move(figure));
}

}  // namespace runcert
