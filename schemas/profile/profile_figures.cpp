#include <fmt/format.h>

#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/profile/profile.h"

namespace runcert {
namespace {

/// A figure of a profile that an attempt may replace.
struct Figure {
    double* value = nullptr;  ///< null: the profile has no such figure
    double per_unit = 1.0;    ///< of the value, for one of `unit`
    std::string unit = {};
    double least = 0.0;  ///< range of the value, both ends allowed
    double most = 1e9;
};

Figure figure_of(Profile& profile, std::string_view name) {
    if (name == "window.duration_s" && profile.window_kind == WindowKind::time)
        return {.value = &profile.duration_s, .unit = "s", .least = 0.1, .most = 3600.0};
    if (name == "window.distance_m" && profile.window_kind != WindowKind::time)
        return {.value = &profile.distance_m, .unit = "m", .least = 1.0, .most = 1e6};
    if (name == "margin.value")
        return {.value = &profile.margin,
                .per_unit = profile.margin_kind == MarginKind::absolute
                                ? metres_per_second(profile.margin_unit)
                                : 1.0,
                .unit = profile.margin_unit};
    if (name == "accuracy.limit" && profile.accuracy_limit_m_s)
        return {.value = &*profile.accuracy_limit_m_s,
                .per_unit = metres_per_second(profile.accuracy_unit),
                .unit = profile.accuracy_unit};
    if (name == "accuracy.coverage_factor" && profile.accuracy_limit_m_s)
        return {.value = &profile.coverage_factor, .least = 1.0, .most = 4.0};
    if (name == "decision.probability")
        return {.value = &profile.decision_probability, .least = 0.51, .most = 0.9999};
    if (name == "opposite_runs.within_s" && profile.opposite_runs_within_s)
        return {.value = &*profile.opposite_runs_within_s, .unit = "s", .least = 1.0, .most = 1e6};
    for (Clause& clause : profile.clauses)
        if (clause.limit && name == "clauses." + clause.id + ".limit")
            return {.value = &*clause.limit, .unit = clause.unit, .least = -1e9};
    return {};
}

std::string known_figures(Profile profile) {
    std::vector<std::string> names{
        "window.duration_s",     "window.distance_m",        "margin.value",
        "accuracy.limit",        "accuracy.coverage_factor", "decision.probability",
        "opposite_runs.within_s"};
    for (const Clause& clause : profile.clauses)
        names.push_back("clauses." + clause.id + ".limit");
    std::string known;
    for (const std::string& name : names)
        if (figure_of(profile, name).value != nullptr) known += (known.empty() ? "" : ", ") + name;
    return known;
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
    const Figure found = figure_of(profile, figure.figure);
    if (found.value == nullptr)
        throw Failure(figure.place,
                      fmt::format("the profile {} has no figure \"{}\"", profile.id,
                                  escape_for_message(figure.figure)),
                      "Use one of: " + known_figures(profile));
    const double used = figure.used;
    if (!(used >= found.least && used <= found.most))
        throw Failure(figure.place,
                      fmt::format("{} cannot be {:g}{}{}", figure.figure, used,
                                  found.unit.empty() ? "" : " ", found.unit),
                      fmt::format("Give a figure from {:g} to {:g}", found.least, found.most));
    figure.rule = *found.value / found.per_unit;
    figure.unit = found.unit;
    *found.value = used * found.per_unit;
    profile.overrides.push_back(std::move(figure));
}

}  // namespace runcert
