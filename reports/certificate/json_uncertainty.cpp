#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_parts.h"

namespace runcert {
namespace {

std::string difference_text(double difference_m_s, const UncertaintyScale& scale) {
    const std::string text = format_fixed(difference_m_s * scale.unit.per_m_s, 4);
    return fmt::format("{}{} {}", difference_m_s > 0.0 ? "+" : "", text, scale.unit.name);
}

std::string uncertainty_with_unit(double uncertainty_m_s, const UncertaintyScale& scale) {
    return fmt::format("{} {}", uncertainty_text(uncertainty_m_s * scale.unit.per_m_s),
                       scale.unit.name);
}

std::string metres(double length_m) {
    return format_fixed(length_m, 4) + " m";
}

Json fitted_json(const FittedSpeed& fitted, const UncertaintyScale& scale) {
    const double expanded_m_s = scale.coverage_factor * fitted.standard_uncertainty_m_s;
    Json json = members_json(fitted);
    json["fitted_words"] = fmt::format(
        "{} (k = {}), by {}",
        speed_with_uncertainty_text(fitted.speed_m_s, expanded_m_s, scale.unit),
        coverage_text(scale.coverage_factor),
        fitted.models == 1 ? std::string("one noise model")
                           : fmt::format("{} noise models, averaged over their profile likelihood",
                                         fitted.models));
    return json;
}

Json robust_json(const RobustSpeed& robust, const UncertaintyScale& scale) {
    Json json = members_json(robust);
    json["robust_words"] = fmt::format(
        "{} {}: {} with the screened solution of the same noise (difference {}, limit {}); {} of "
        "the window at less than half weight",
        speed_text(robust.speed_m_s, robust.limit_m_s, scale.unit), scale.unit.name,
        robust.agrees ? "agrees" : "does not agree", difference_text(robust.difference_m_s, scale),
        uncertainty_with_unit(robust.limit_m_s, scale), counted(robust.downweighted, "epoch"));
    return json;
}

Json witnesses_json(const std::vector<WitnessedSpeed>& witnesses, const UncertaintyScale& scale) {
    Json json = Json::array();
    for (const WitnessedSpeed& one : witnesses) {
        json.push_back(members_json(one));
        json.back()["witness_words"] = fmt::format(
            "{}: {}, by positions {}; the two {} (normalised error {:.2f}, at most 1). Beside it "
            "errors of the positions of any kind change the speed by {} at most (k = 2)",
            one.receiver.empty() ? std::string(words_of(one.kind))
                                 : fmt::format("positions of receiver “{}”", one.receiver),
            speed_with_uncertainty_text(
                one.speed_m_s, scale.coverage_factor * one.standard_uncertainty_m_s, scale.unit),
            difference_text(one.difference_m_s, scale),
            contradicts(one) ? "contradict one another" : "agree", one.normalised_error,
            uncertainty_with_unit(largest_error_beside(one), scale));
    }
    return json;
}

std::string decided_words(const ErrorBound& bound) {
    if (bound.decided_by == BoundSource::fitted) return "the size fitted to the recording";
    if (bound.decided_by == BoundSource::stated)
        return "the stated standard deviation times its scale";
    return !bound.floor_fix
               ? "the floor that the rule sets"
               : fmt::format("the floor for the fix type “{}”", words_of(*bound.floor_fix));
}

Json bound_json(const ErrorBound& bound, const UncertaintyScale& scale) {
    Json json = members_json(bound);
    json["bound_words"] = fmt::format(
        "allowed for up to a standard deviation of {}, with any correlation time from {:g} s to "
        "{:g} s. Decided by {}: fitted {}{}, stated times its scale {}, floor {}. The positions "
        "alone so give u = {}",
        metres(bound.sigma_m), bound.tau_min_s, bound.tau_max_s, decided_words(bound),
        metres(bound.fitted_m),
        bound.along > 1.0
            ? fmt::format(" ({:.2f} times that of both axes, along the track)", bound.along)
            : std::string(),
        metres(bound.stated_m), metres(bound.floor_m),
        uncertainty_with_unit(bound.standard_uncertainty_m_s, scale));
    return json;
}

std::string treatment_words(const SelectionBias& selection, const UncertaintyScale& scale) {
    return selection.treatment == SelectionTreatment::subtracted
               ? fmt::format(
                     "the middle, {}, is subtracted from the speed, and half the difference, {}, "
                     "added to the expanded uncertainty",
                     difference_text(selection.bias_m_s, scale),
                     uncertainty_with_unit(selection.bias_half_range_m_s, scale))
               : "the larger is added to the expanded uncertainty";
}

Json estimates_json(const OtherEstimates& other, const UncertaintyScale& scale) {
    Json json = members_json(other);
    const auto speed = [&](double speed_m_s) {
        return speed_text(speed_m_s, std::max(other.half_width_m_s, 1e-3), scale.unit);
    };
    json["estimates_words"] = fmt::format(
        "a third of the jerk density gives {}, three times as much {}, the one density fitted to "
        "the whole recording {}{} {}; the choice of the model is taken to change at most {}",
        speed(other.stiffer_m_s), speed(other.softer_m_s), speed(other.whole_m_s),
        other.chord_m_s
            ? fmt::format(", the measured positions at both ends alone {}", speed(*other.chord_m_s))
            : std::string(),
        scale.unit.name, uncertainty_with_unit(other.half_width_m_s, scale));
    return json;
}

Json selection_json(const SelectionBias& selection, std::int64_t compared,
                    const UncertaintyScale& scale) {
    Json json = members_json(selection);
    json["selection_words"] = fmt::format(
        "The fastest of {} was chosen; {} could have been it. That makes its speed look higher by "
        "{} with the errors as fitted, by {} with time-correlated errors as large as allowed for; "
        "{}.",
        counted(compared, "window"), selection.candidates,
        uncertainty_with_unit(selection.fitted_bias_m_s, scale),
        uncertainty_with_unit(selection.bounded_bias_m_s, scale),
        treatment_words(selection, scale));
    const auto distribution = [&](double mean_m_s, double sd_m_s) {
        return fmt::format("{} {}, standard deviation {}", speed_text(mean_m_s, sd_m_s, scale.unit),
                           scale.unit.name, uncertainty_with_unit(sd_m_s, scale));
    };
    json["distribution_words"] = fmt::format(
        "True speed over {} (seed {}): of the window chosen {}; of the window truly fastest {}.",
        counted(selection.samples, "sample"), selection.seed,
        distribution(selection.chosen_mean_m_s, selection.chosen_sd_m_s),
        distribution(selection.best_mean_m_s, selection.best_sd_m_s));
    return json;
}

/// What the budget is of, where that is not the whole of the measured speed.
std::string budget_subject(const ProfileVerdict& verdict, const ProfileWindows& windows,
                           const UncertaintyScale& scale) {
    const CertifiableWindow& best = *windows.best;
    if (windows.further.empty() && !verdict.current_subtracted_m_s) return {};
    return fmt::format(
        "What follows is of the fastest window alone, of {}{}{}.",
        speed_with_uncertainty_text(
            best.speed_m_s, expanded_uncertainty_m_s(best, scale.coverage_factor), scale.unit),
        windows.further.empty()
            ? ""
            : fmt::format("; the measured speed is the mean of {} windows, with the mean of their "
                          "uncertainties, as if their errors were the same",
                          windows.further.size() + 1),
        verdict.current_subtracted_m_s
            ? "; the current's component is subtracted from it, and adds its own uncertainty"
            : "");
}

/// Lines beneath the measured speed.
Json comparison_facts(const Json& uncertainty) {
    Json facts = Json::array();
    const auto add = [&](const char* label, const char* part, const char* words) {
        if (uncertainty.contains(part))
            add_fact(facts, label, uncertainty[part][words].get<std::string>());
    };
    if (uncertainty.contains("witnesses"))
        for (const Json& one : uncertainty["witnesses"])
            add_fact(facts, "A second measurement", one["witness_words"].get<std::string>());
    add("With the fitted noise alone", "fitted", "fitted_words");
    add("Robust estimate", "robust", "robust_words");
    add("Other models of the motion", "estimates", "estimates_words");
    add("Time-correlated position errors", "bound", "bound_words");
    return facts;
}

}  // namespace

Json uncertainty_json(const ProfileVerdict& verdict, const ProfileWindows& windows,
                      const Profile& profile) {
    const CertifiableWindow& best = windows.best.value();
    const UncertaintyScale scale{rule_unit(profile), verdict.coverage_factor};
    const ShownFigures shown =
        verdict.speed_m_s ? shown_of(verdict, scale.unit.name)
                          : shown_in({.speed_m_s = best.speed_m_s,
                                      .expanded_uncertainty_m_s =
                                          expanded_uncertainty_m_s(best, scale.coverage_factor)},
                                     scale.unit);
    Json json{{"certified_words", measured_speed_text(shown, scale.coverage_factor)}};
    if (const std::string words = budget_subject(verdict, windows, scale); !words.empty())
        json["budget_subject"] = words;
    if (best.effective_degrees_of_freedom)
        json["effective_degrees_of_freedom"] = rounded(*best.effective_degrees_of_freedom, 2);
    if (best.fitted) json["fitted"] = fitted_json(*best.fitted, scale);
    json["bias_limit_m_s"] = rounded(best.bias_limit_m_s, 6);
    if (best.own_standard_uncertainty_m_s)
        json["own_standard_uncertainty_m_s"] = rounded(*best.own_standard_uncertainty_m_s, 6);
    if (!best.witnesses.empty()) json["witnesses"] = witnesses_json(best.witnesses, scale);
    if (best.estimates) json["estimates"] = estimates_json(*best.estimates, scale);
    if (best.robust) json["robust"] = robust_json(*best.robust, scale);
    if (best.bound) json["bound"] = bound_json(*best.bound, scale);
    if (best.selection)
        json["selection"] = selection_json(*best.selection, windows.candidates, scale);
    json["budget"] = budget_json(best, scale);
    if (!best.budget.empty()) json["budget_total"] = budget_total_json(best, scale);
    if (best.monte_carlo) json["monte_carlo"] = monte_carlo_json(best, scale);
    json["comparison"] = comparison_facts(json);
    return json;
}

}  // namespace runcert
