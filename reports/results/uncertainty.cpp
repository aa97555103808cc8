#include <fmt/format.h>

#include <algorithm>

#include "reports/results/results.h"

namespace runcert {
namespace {

std::string signed_text(const RuleView& rule, double difference_m_s) {
    const double difference = difference_m_s * rule.unit().per_m_s;
    return fmt::format("{}{} {}", difference > 0.0 ? "+" : "", significant_text(difference, 2),
                       rule.unit().name);
}

std::string metres(double length_m) {
    return significant_text(length_m, 2) + " m";
}

std::string fitted_text(const FittedSpeed& fitted, const RuleView& rule) {
    const double k = rule.verdict.coverage_factor;
    return fmt::format("{} (k = {}), by {}",
                       speed_with_uncertainty_text(
                           fitted.speed_m_s, k * fitted.standard_uncertainty_m_s, rule.unit()),
                       coverage_text(k),
                       fitted.models == 1
                           ? "one noise model"
                           : fmt::format("{} noise models, averaged over their profile likelihood",
                                         fitted.models));
}

std::string robust_text(const RobustSpeed& robust, const RuleView& rule) {
    return fmt::format(
        "{} {}: {} with the screened solution of the same noise (difference {}, limit {}); {} of "
        "the window at less than half weight",
        speed_text(robust.speed_m_s, robust.limit_m_s, rule.unit()), rule.unit().name,
        robust.agrees ? "agrees" : "does not agree", signed_text(rule, robust.difference_m_s),
        rule.uncertainty_text(robust.limit_m_s), counted(robust.downweighted, "epoch"));
}

std::string estimates_text(const OtherEstimates& other, const RuleView& rule) {
    const auto speed = [&](double speed_m_s) {
        return speed_text(speed_m_s, std::max(other.half_width_m_s, 1e-3), rule.unit());
    };
    return fmt::format(
        "a third of the jerk density gives {}, three times as much {}, the one density fitted to "
        "the whole recording {}{} {}; the choice of the model is taken to change at most {}",
        speed(other.stiffer_m_s), speed(other.softer_m_s), speed(other.whole_m_s),
        other.chord_m_s
            ? fmt::format(", the measured positions at both ends alone {}", speed(*other.chord_m_s))
            : "",
        rule.unit().name, rule.uncertainty_text(other.half_width_m_s));
}

std::string decided_words(const ErrorBound& bound) {
    if (bound.decided_by == BoundSource::fitted) return "the size fitted to the recording";
    if (bound.decided_by == BoundSource::stated)
        return "the stated standard deviation times its scale";
    if (bound.decided_by == BoundSource::standing)
        return "what the positions showed while the craft stood";
    return !bound.floor_fix
               ? "the floor that the rule sets"
               : fmt::format("the floor for the fix type “{}”", words_of(*bound.floor_fix));
}

std::string bound_text(const ErrorBound& bound, const RuleView& rule) {
    return fmt::format(
        "allowed for up to a standard deviation of {}, with any correlation time from {:g} s to "
        "{:g} s. Decided by {}: fitted {}{}, stated times its scale {}{}, floor {}. The positions "
        "alone so give u = {}",
        metres(bound.sigma_m), bound.tau_min_s, bound.tau_max_s, decided_words(bound),
        metres(bound.fitted_m),
        bound.along > 1.0
            ? fmt::format(" ({:.2f} times that of both axes, along the track)", bound.along)
            : "",
        metres(bound.stated_m),
        bound.standing_m ? ", while the craft stood " + metres(*bound.standing_m) : "",
        metres(bound.floor_m), rule.uncertainty_text(bound.standard_uncertainty_m_s));
}

std::string selection_text(const SelectionBias& selection, const RuleView& rule) {
    const std::string chosen =
        fmt::format("The fastest of {} was chosen; {} could have been it. ",
                    counted(rule.windows->candidates, "window"), selection.candidates);
    if (selection.samples == 0)
        return chosen +
               "What that adds to its speed was not simulated: the expanded uncertainty exceeds "
               "the rule's limit without it.";
    const auto distribution = [&](double mean_m_s, double sd_m_s) {
        return fmt::format("{} {}, standard deviation {}",
                           speed_text(mean_m_s, sd_m_s, rule.unit()), rule.unit().name,
                           rule.uncertainty_text(sd_m_s));
    };
    return fmt::format(
        "{}That makes its speed look higher by {} with the errors as fitted, by {} with "
        "time-correlated errors as large as allowed for; {}. True speed over {} (seed {}): of the "
        "window chosen {}; of the window truly fastest {}.",
        chosen, rule.uncertainty_text(selection.fitted_bias_m_s),
        rule.uncertainty_text(selection.bounded_bias_m_s),
        selection.treatment == SelectionTreatment::subtracted
            ? fmt::format("the middle, {}, is subtracted from the speed, and half the difference, "
                          "{}, added to the expanded uncertainty",
                          signed_text(rule, selection.bias_m_s),
                          rule.uncertainty_text(selection.bias_half_range_m_s))
            : "the larger is added to the expanded uncertainty",
        counted(selection.samples, "sample"), selection.seed,
        distribution(selection.chosen_mean_m_s, selection.chosen_sd_m_s),
        distribution(selection.best_mean_m_s, selection.best_sd_m_s));
}

/// What the budget is of, where that is not the whole of the measured speed.
std::string budget_subject(const RuleView& rule) {
    const auto& further = rule.windows->further;
    const auto& current = rule.verdict.current_subtracted_m_s;
    if (further.empty() && !current) return {};
    const CertifiableWindow& best = *rule.best();
    return fmt::format(
        "What follows is of the fastest window alone, of {}{}{}.",
        speed_with_uncertainty_text(best.speed_m_s,
                                    expanded_uncertainty_m_s(best, rule.verdict.coverage_factor),
                                    rule.unit()),
        further.empty()
            ? ""
            : fmt::format("; the measured speed is the mean of {} windows, with the mean of their "
                          "uncertainties, as if their errors were the same",
                          further.size() + 1),
        current ? "; the current's component is subtracted from it, and adds its own uncertainty"
                : "");
}

/// What of an error that nothing found is in the interval, and what is not.
std::string drift_text(const RuleView& rule) {
    const CertifiableWindow& window = *rule.best();
    if (!window.evidence || window.evidence->fault_probability == 0.0) return {};
    const SpeedEvidence& evidence = *window.evidence;
    const SpeedUnit& unit = rule.unit();
    const auto expanded = [&](double standard_m_s) {
        return shown_in({.expanded_uncertainty_m_s =
                             rule.verdict.coverage_factor * standard_m_s + window.bias_limit_m_s},
                        unit)
            .expanded_uncertainty;
    };
    const bool rare = evidence.fault_probability <= 0.05;
    const auto heard = std::ranges::max_element(window.witnesses, {}, &WitnessedSpeed::share);
    return fmt::format(
        "{} the positions are taken to err unseen, by up to {} {}. The interval carries that risk "
        "on average (row d){}. Taken a fifth as often, the expanded uncertainty would be {} {}; "
        "five times as often, {} {}.{}",
        rare ? fmt::format("In one window of {:.0f}", 1.0 / evidence.fault_probability)
             : fmt::format("With a probability of {:.0f} %", 100.0 * evidence.fault_probability),
        significant_text(evidence.fault_m_s * unit.per_m_s, 3), unit.name,
        rare ? ", and would not hold the speed of such a window" : "",
        expanded(evidence.at_a_fifth_m_s), unit.name, expanded(evidence.at_five_times_m_s),
        unit.name,
        heard != window.witnesses.end() && heard->share > 0.0
            ? fmt::format(" Beside the {} an error of more than {} {} would have been found with a "
                          "probability of 80 %.",
                          words_of(heard->kind),
                          significant_text(heard->undetected_m_s * unit.per_m_s, 3), unit.name)
            : "");
}

/// "at epoch 812", "before epoch 812", "from epoch 812 on", "at epochs 812 to 815".
std::string where_text(const UndetectedError& error) {
    if (error.epoch != error.last_epoch)
        return fmt::format("at epochs {} to {}", error.epoch, error.last_epoch);
    const bool at_it =
        error.hypothesis == Hypothesis::outlier || error.hypothesis == Hypothesis::burst;
    const bool from_it = error.hypothesis == Hypothesis::ramp;
    return fmt::format("{} epoch {}{}",
                       at_it     ? "at"
                       : from_it ? "from"
                                 : "before",
                       error.epoch, from_it ? " on" : "");
}

void add_undetected(std::vector<Block>& blocks, const RuleView& rule) {
    const CertifiableWindow& window = *rule.best();
    if (!window.detection_power || window.reliability.empty()) return;
    blocks.push_back(heading("Undetected errors"));
    blocks.push_back(paragraph(fmt::format(
        "An error larger than the size below is found with a probability of more than {:g}.",
        *window.detection_power)));
    Block block = table({"Error|38", "Where it matters most|26", ">Size that could be missed|18",
                         fmt::format(">Change of the speed, {}|18", rule.unit().name)});
    constexpr double without_limit = 1e6;  // stands in the file for one without limit
    for (const UndetectedError& error : window.reliability) {
        const std::string name = tested_error_text(error.hypothesis);
        if (!(error.speed_m_s > 0.0))
            add_row(block, {name, "–", "–", "0"});
        else if (error.size >= without_limit || error.speed_m_s >= without_limit)
            add_row(block, {name, where_text(error), "any", "no limit"});
        else
            add_row(block, {name, where_text(error),
                            fmt::format("{} {}", significant_text(error.size, 2),
                                        error.unit == "m / s" ? "m/s" : error.unit),
                            significant_text(error.speed_m_s * rule.unit().per_m_s, 3)});
    }
    blocks.push_back(std::move(block));
    if (std::string text = drift_text(rule); !text.empty())
        blocks.push_back(paragraph(std::move(text), "note"));
}

}  // namespace

std::string tested_error_text(Hypothesis hypothesis) {
    return hypothesis == Hypothesis::outlier ? "outlier of one epoch"
           : hypothesis == Hypothesis::burst ? "outlier of several epochs"
           : hypothesis == Hypothesis::step  ? "step of the positions"
           : hypothesis == Hypothesis::ramp  ? "drift of the positions"
                                             : std::string(words_of(hypothesis));
}

std::vector<Block> uncertainty_blocks(const RuleView& rule) {
    const CertifiableWindow& best = *rule.best();
    std::vector<Block> blocks;
    if (std::string subject = budget_subject(rule); !subject.empty())
        blocks.push_back(paragraph(std::move(subject)));
    Block beside = facts({});
    const auto add_one = [&](const char* name, const auto& figure, auto text) {
        if (figure) add_fact(beside, name, text(*figure, rule));
    };
    add_one("With the fitted noise alone", best.fitted, fitted_text);
    add_one("Robust estimate", best.robust, robust_text);
    add_one("Other models of the motion", best.estimates, estimates_text);
    add_one("Time-correlated position errors", best.bound, bound_text);
    if (!beside.facts.empty()) blocks.push_back(std::move(beside));
    add(blocks, budget_blocks(rule));
    if (best.selection && rule.windows->candidates > 1) {
        blocks.push_back(heading("Choice of the fastest window"));
        blocks.push_back(paragraph(selection_text(*best.selection, rule)));
    }
    add_undetected(blocks, rule);
    return blocks;
}

}  // namespace runcert
