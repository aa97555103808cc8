#include <fmt/format.h>

#include <array>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/compare/compare.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

/// By the order of SpeedDefinition.
constexpr std::array short_names{"d/T", "path/T", "N+1", "N", "L/T"};

Section rule_section(const ProfileComparison& profile, const Record* record, bool with_truth) {
    const ProfileWindows& windows = profile.windows;
    const SpeedUnit& unit = speed_unit(record ? record->unit : "");
    const int decimals = decimals_of(
        (windows.best ? expanded_uncertainty_m_s(*windows.best, 2.0) : 0.0) * unit.per_m_s,
        std::nullopt);
    const auto speed = [&](const std::optional<double>& speed_m_s) -> std::string {
        return speed_m_s ? shown_speed(SpeedKind::measured, *speed_m_s, decimals, unit) : "-";
    };
    // Against a truth that has no uncertainty: with one decimal more.
    const auto error = [&](const std::optional<double>& error_m_s) -> std::string {
        return error_m_s ? format_fixed(*error_m_s * unit.per_m_s, decimals + 1) : "-";
    };
    Block block =
        facts({{"Speed", fmt::format("over {}, {}", time_span_text(windows.rule.duration_s),
                                     words_of(windows.rule.definition))},
               {"Windows", counted(profile.candidates) + " can be certified"},
               {"Certified window",
                windows.best ? fmt::format("{} from {}", seconds_text(windows.best->span.duration),
                                           seconds_text(windows.best->span.start))
                             : "none"}});
    if (profile.true_m_s)
        add_fact(block, "True speed in it",
                 fmt::format("{} {}", speed(profile.true_m_s), unit.name));
    Block speeds = table({"method", "by", ">best from, s", ">best", ">certified"},
                         fmt::format("Speeds in the best window of each method and in the "
                                     "certified one, {}",
                                     unit.name));
    Block errors = table({"method", ">RMS", ">best", ">certified"},
                         fmt::format("Errors of its speeds, and in these windows, {}", unit.name));
    for (const MethodResult& method : profile.methods) {
        add_row(speeds,
                {method.name, short_names[static_cast<std::size_t>(method.window_speed)],
                 method.best_start ? format_fixed(method.best_start->seconds(), 3) : "-",
                 speed(method.best_m_s), speed(method.certified_m_s)},
                method.name == "certified" ? "chosen" : "");
        add_row(errors, {method.name, error(method.rms_error_m_s), error(method.best_error_m_s),
                         error(method.certified_error_m_s)});
    }
    Section section{.anchor = windows.profile,
                    .title = "Rule " + windows.profile,
                    .blocks = {std::move(block), std::move(speeds)}};
    if (with_truth) add(section, std::move(errors));
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
        document.sections.push_back(rule_section(
            profile, attempt.record_for(profile.windows.profile), comparison.with_truth));
    document.sections.push_back(legend(comparison));
    return document;
}

}  // namespace runcert
