#include <fmt/format.h>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/compare/compare.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

std::string in_seconds(std::optional<ElapsedTime> time) {
    return time ? format_fixed(time->seconds(), 3) : "-";
}

std::string_view short_name(SpeedDefinition definition) {
    switch (definition) {
        case SpeedDefinition::displacement:
            return "d/T";
        case SpeedDefinition::path_length:
            return "path/T";
        case SpeedDefinition::mean_n_plus_1:
            return "N+1";
        case SpeedDefinition::mean_n:
            return "N";
        case SpeedDefinition::elapsed_time:
            return "L/T";
    }
    return "";
}

/// How the speeds of one rule are written, without their unit.
struct ShownSpeeds {
    SpeedUnit unit;
    int decimals = 2;

    std::string speed(std::optional<double> speed_m_s) const {
        return speed_m_s ? shown_figure(*speed_m_s * unit.per_m_s, decimals, SafeSide::down) : "-";
    }
    /// Against a truth that has no uncertainty: with one decimal more.
    std::string error(std::optional<double> error_m_s) const {
        return error_m_s ? format_fixed(*error_m_s * unit.per_m_s, decimals + 1) : "-";
    }
};

Block speeds_table(const ProfileComparison& profile, const ShownSpeeds& shown) {
    Block speeds = table({"method", "by", ">best from, s", ">best", ">certified"},
                         fmt::format("Speeds in the best window of each method and in the "
                                     "certified one, {}",
                                     shown.unit.name));
    for (const MethodResult& method : profile.methods)
        add_row(speeds,
                {method.name, std::string(short_name(method.window_speed)),
                 in_seconds(method.best_start), shown.speed(method.best_m_s),
                 shown.speed(method.certified_m_s)},
                method.name == "certified" ? "chosen" : "");
    return speeds;
}

Block errors_table(const ProfileComparison& profile, const ShownSpeeds& shown) {
    Block errors =
        table({"method", ">RMS", ">best", ">certified"},
              fmt::format("Errors of its speeds, and in these windows, {}", shown.unit.name));
    for (const MethodResult& method : profile.methods)
        add_row(errors,
                {method.name, shown.error(method.rms_error_m_s), shown.error(method.best_error_m_s),
                 shown.error(method.certified_error_m_s)});
    return errors;
}

Section rule_section(const ProfileComparison& profile, const Record* record, bool with_truth) {
    const SpeedUnit& unit = speed_unit(record ? record->unit : "");
    const ShownSpeeds shown{
        unit, decimals_of(profile.expanded_uncertainty_m_s * unit.per_m_s, std::nullopt)};
    std::string certified = "none";
    if (profile.certified_start)
        certified = fmt::format("{} s from {} s", in_seconds(profile.certified_duration),
                                in_seconds(profile.certified_start));
    Block told = facts({{"Speed", fmt::format("over {}, {}", time_span_text(profile.duration_s),
                                              words_of(profile.definition))},
                        {"Windows", counted(profile.candidates) + " can be certified"},
                        {"Certified window", certified}});
    if (profile.true_m_s)
        add_fact(told, "True speed in it",
                 fmt::format("{} {}", shown.speed(profile.true_m_s), unit.name));
    Section section{.anchor = profile.profile,
                    .title = "Rule " + profile.profile,
                    .blocks = {std::move(told), speeds_table(profile, shown)}};
    if (with_truth) add(section, errors_table(profile, shown));
    return section;
}

Section legend(const Comparison& comparison) {
    std::vector<std::string> items{
        "by: d/T displacement over time, path/T path length over time; N+1 mean of the window's "
        "speeds, both ends included; N the same without the first, each speed being that of the "
        "step before it.",
        "certified: the speed that the certificate states, and each method's in the same window."};
    if (comparison.with_truth)
        items.push_back(fmt::format(
            "Errors are estimate less truth. The truth of a window is by the profile's definition; "
            "RMS is of the speeds at {} of {} epochs, those with truth.",
            comparison.epochs_with_truth, comparison.epochs));
    for (const std::string& note : comparison.notes)
        items.push_back(sentence(note));
    return {.anchor = "legend", .title = "Legend and notes", .blocks = {list_of(std::move(items))}};
}

}  // namespace

Document comparison_document(const Comparison& comparison, const Attempt& attempt) {
    Document document{
        .title = "All estimators side by side",
        .subtitle = fmt::format("Attempt {}, receiver {}", attempt.id, comparison.receiver)};
    for (const ProfileComparison& profile : comparison.profiles)
        document.sections.push_back(
            rule_section(profile, attempt.record_for(profile.profile), comparison.with_truth));
    document.sections.push_back(legend(comparison));
    return document;
}

}  // namespace runcert
