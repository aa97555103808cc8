#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// Speeds of a rule, in its unit.
class Scale {
  public:
    explicit Scale(const RuleView& rule)
        : unit_(rule.unit()), coverage_factor_(rule.verdict.coverage_factor) {}

    const SpeedUnit& unit() const { return unit_; }
    double coverage_factor() const { return coverage_factor_; }

    std::string signed_text(double difference_m_s) const {
        const double difference = difference_m_s * unit_.per_m_s;
        return fmt::format("{}{} {}", difference > 0.0 ? "+" : "", significant_text(difference, 2),
                           unit_.name);
    }
    std::string uncertainty(double uncertainty_m_s) const {
        return fmt::format("{} {}", uncertainty_text(uncertainty_m_s * unit_.per_m_s), unit_.name);
    }
    std::string speed(double speed_m_s, double uncertainty_m_s) const {
        return speed_text(speed_m_s, uncertainty_m_s, unit_);
    }
    std::string with_uncertainty(double speed_m_s, double standard_m_s) const {
        return speed_with_uncertainty_text(speed_m_s, coverage_factor_ * standard_m_s, unit_);
    }

  private:
    const SpeedUnit& unit_;
    double coverage_factor_;
};

std::string metres(double length_m) {
    return significant_text(length_m, 2) + " m";
}

std::string fitted_text(const FittedSpeed& fitted, const Scale& scale) {
    return fmt::format("{} (k = {}), by {}",
                       scale.with_uncertainty(fitted.speed_m_s, fitted.standard_uncertainty_m_s),
                       coverage_text(scale.coverage_factor()),
                       fitted.models == 1
                           ? std::string("one noise model")
                           : fmt::format("{} noise models, averaged over their profile likelihood",
                                         fitted.models));
}

std::string robust_text(const RobustSpeed& robust, const Scale& scale) {
    return fmt::format(
        "{} {}: {} with the screened solution of the same noise (difference {}, limit {}); {} of "
        "the window at less than half weight",
        scale.speed(robust.speed_m_s, robust.limit_m_s), scale.unit().name,
        robust.agrees ? "agrees" : "does not agree", scale.signed_text(robust.difference_m_s),
        scale.uncertainty(robust.limit_m_s), counted(robust.downweighted, "epoch"));
}

std::string estimates_text(const OtherEstimates& other, const Scale& scale) {
    const auto speed = [&](double speed_m_s) {
        return scale.speed(speed_m_s, std::max(other.half_width_m_s, 1e-3));
    };
    return fmt::format(
        "a third of the jerk density gives {}, three times as much {}, the one density fitted to "
        "the whole recording {}{} {}; the choice of the model is taken to change at most {}",
        speed(other.stiffer_m_s), speed(other.softer_m_s), speed(other.whole_m_s),
        other.chord_m_s
            ? fmt::format(", the measured positions at both ends alone {}", speed(*other.chord_m_s))
            : std::string(),
        scale.unit().name, scale.uncertainty(other.half_width_m_s));
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

std::string bound_text(const ErrorBound& bound, const Scale& scale) {
    return fmt::format(
        "allowed for up to a standard deviation of {}, with any correlation time from {:g} s to "
        "{:g} s. Decided by {}: fitted {}{}, stated times its scale {}{}, floor {}. The positions "
        "alone so give u = {}",
        metres(bound.sigma_m), bound.tau_min_s, bound.tau_max_s, decided_words(bound),
        metres(bound.fitted_m),
        bound.along > 1.0
            ? fmt::format(" ({:.2f} times that of both axes, along the track)", bound.along)
            : std::string(),
        metres(bound.stated_m),
        bound.standing_m ? fmt::format(", while the craft stood {}", metres(*bound.standing_m))
                         : std::string(),
        metres(bound.floor_m), scale.uncertainty(bound.standard_uncertainty_m_s));
}

std::string treatment_words(const SelectionBias& selection, const Scale& scale) {
    return selection.treatment == SelectionTreatment::subtracted
               ? fmt::format(
                     "the middle, {}, is subtracted from the speed, and half the difference, {}, "
                     "added to the expanded uncertainty",
                     scale.signed_text(selection.bias_m_s),
                     scale.uncertainty(selection.bias_half_range_m_s))
               : "the larger is added to the expanded uncertainty";
}

void add_selection(std::vector<Block>& blocks, const RuleView& rule, const Scale& scale) {
    const SelectionBias& selection = *rule.best()->selection;
    const auto distribution = [&](double mean_m_s, double sd_m_s) {
        return fmt::format("{} {}, standard deviation {}", scale.speed(mean_m_s, sd_m_s),
                           scale.unit().name, scale.uncertainty(sd_m_s));
    };
    blocks.push_back(heading("Choice of the fastest window"));
    if (selection.samples == 0) {
        blocks.push_back(paragraph(fmt::format(
            "The fastest of {} was chosen; {} could have been it. What that adds to its speed was "
            "not simulated: the expanded uncertainty exceeds the rule's limit without it.",
            counted(rule.windows->candidates, "window"), selection.candidates)));
        return;
    }
    blocks.push_back(paragraph(fmt::format(
        "The fastest of {} was chosen; {} could have been it. That makes its speed look higher "
        "by {} with the errors as fitted, by {} with time-correlated errors as large as "
        "allowed for; {}. True speed over {} (seed {}): of the window chosen {}; of the window "
        "truly fastest {}.",
        counted(rule.windows->candidates, "window"), selection.candidates,
        scale.uncertainty(selection.fitted_bias_m_s), scale.uncertainty(selection.bounded_bias_m_s),
        treatment_words(selection, scale), counted(selection.samples, "sample"), selection.seed,
        distribution(selection.chosen_mean_m_s, selection.chosen_sd_m_s),
        distribution(selection.best_mean_m_s, selection.best_sd_m_s))));
}

/// What the budget is of, where that is not the whole of the measured speed.
std::string budget_subject(const RuleView& rule, const Scale& scale) {
    const auto& further = rule.windows->further;
    const auto& current = rule.verdict.current_subtracted_m_s;
    if (further.empty() && !current) return {};
    const CertifiableWindow& best = *rule.best();
    return fmt::format(
        "What follows is of the fastest window alone, of {}{}{}.",
        speed_with_uncertainty_text(
            best.speed_m_s, expanded_uncertainty_m_s(best, scale.coverage_factor()), scale.unit()),
        further.empty()
            ? ""
            : fmt::format("; the measured speed is the mean of {} windows, with the mean of their "
                          "uncertainties, as if their errors were the same",
                          further.size() + 1),
        current ? "; the current's component is subtracted from it, and adds its own uncertainty"
                : "");
}

/// What of an error that nothing found is in the interval, and what is not.
std::string drift_words(const CertifiableWindow& window, const WitnessedSpeed* heard,
                        const Scale& scale) {
    if (!window.evidence || window.evidence->fault_probability == 0.0) return {};
    const SpeedEvidence& evidence = *window.evidence;
    const SpeedUnit& unit = scale.unit();
    const auto expanded = [&](double standard_m_s) {
        return shown_in({.expanded_uncertainty_m_s =
                             scale.coverage_factor() * standard_m_s + window.bias_limit_m_s},
                        unit)
            .expanded_uncertainty;
    };
    constexpr double rare = 0.05;
    const std::string taken = fmt::format(
        "{} the positions are taken to err unseen, by up to {} {}. The interval carries that risk "
        "on average (row d){}. Taken a fifth as often, the expanded uncertainty would be {} {}; "
        "five times as "
        "often, {} {}.",
        evidence.fault_probability > rare
            ? fmt::format("With a probability of {:.0f} %", 100.0 * evidence.fault_probability)
            : fmt::format("In one window of {:.0f}", 1.0 / evidence.fault_probability),
        significant_text(evidence.fault_m_s * unit.per_m_s, 3), unit.name,
        evidence.fault_probability > rare ? "" : ", and would not hold the speed of such a window",
        expanded(evidence.at_a_fifth_m_s), unit.name, expanded(evidence.at_five_times_m_s),
        unit.name);
    if (heard == nullptr) return taken;
    return fmt::format(
        "{} Beside the {} an error of more than {} {} would have been found with a probability of "
        "80 %.",
        taken, words_of(heard->kind), significant_text(heard->undetected_m_s * unit.per_m_s, 3),
        unit.name);
}

/// "at epoch 812", "before epoch 812", "from epoch 812 on", "at epochs 812 to 815".
std::string where_text(const UndetectedError& error) {
    if (error.epoch != error.last_epoch)
        return fmt::format("at epochs {} to {}", error.epoch, error.last_epoch);
    switch (error.hypothesis) {
        case Hypothesis::outlier:
        case Hypothesis::burst:
            return fmt::format("at epoch {}", error.epoch);
        case Hypothesis::ramp:
            return fmt::format("from epoch {} on", error.epoch);
        default:
            return fmt::format("before epoch {}", error.epoch);
    }
}

void add_undetected(std::vector<Block>& blocks, const CertifiableWindow& window,
                    const Scale& scale) {
    if (!window.detection_power || window.reliability.empty()) return;
    blocks.push_back(heading("Undetected errors"));
    blocks.push_back(paragraph(fmt::format(
        "An error larger than the size below is found with a probability of more than {:g}.",
        *window.detection_power)));
    Block block = table({"Error|38", "Where it matters most|26", ">Size that could be missed|18",
                         fmt::format(">Change of the speed, {}|18", scale.unit().name)});
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
                            significant_text(error.speed_m_s * scale.unit().per_m_s, 3)});
    }
    blocks.push_back(std::move(block));
    const auto heard = std::ranges::max_element(window.witnesses, {}, &WitnessedSpeed::share);
    const bool shared = heard != window.witnesses.end() && heard->share > 0.0;
    if (std::string words = drift_words(window, shared ? &*heard : nullptr, scale); !words.empty())
        blocks.push_back(paragraph(std::move(words), "note"));
}

}  // namespace

std::string tested_error_text(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return "outlier of one epoch";
        case Hypothesis::burst:
            return "outlier of several epochs";
        case Hypothesis::step:
            return "step of the positions";
        case Hypothesis::ramp:
            return "drift of the positions";
        default:
            return std::string(words_of(hypothesis));
    }
}

std::vector<Block> uncertainty_blocks(const RuleView& rule) {
    const CertifiableWindow& best = *rule.best();
    const Scale scale(rule);
    std::vector<Block> blocks;
    if (std::string words = budget_subject(rule, scale); !words.empty())
        blocks.push_back(paragraph(std::move(words)));
    Block beside = facts({});
    if (best.fitted)
        add_fact(beside, "With the fitted noise alone", fitted_text(*best.fitted, scale));
    if (best.robust) add_fact(beside, "Robust estimate", robust_text(*best.robust, scale));
    if (best.estimates)
        add_fact(beside, "Other models of the motion", estimates_text(*best.estimates, scale));
    if (best.bound)
        add_fact(beside, "Time-correlated position errors", bound_text(*best.bound, scale));
    if (!beside.facts.empty()) blocks.push_back(std::move(beside));
    add(blocks, budget_blocks(rule));
    if (best.selection && rule.windows->candidates > 1) add_selection(blocks, rule, scale);
    add_undetected(blocks, best, scale);
    return blocks;
}

}  // namespace runcert
