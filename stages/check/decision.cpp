#include "stages/check/decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/statistics.h"
#include "core/uncertainty.h"
#include "witness/evidence.h"

namespace runcert {
namespace {

[[noreturn]] void fail(const std::string& what, const char* remedy) {
    throw Failure("decision", what, remedy);
}

void require_finite(double value, const char* name) {
    if (!std::isfinite(value))
        fail(fmt::format("the {} is {}", name, value), "Give a finite number");
}

void require_level(double level) {
    if (!(level > 0.5 && level < 1.0))
        fail(fmt::format("the level {} is not in (0.5, 1)", level), "Give a level such as 0.95");
}

/// Student's t distribution of the speed minus a limit.
struct Difference {
    double location_m_s = 0.0;
    double scale_m_s = 0.0;
    std::optional<double> degrees_of_freedom = std::nullopt;
};

/// At which end of its range the bias is.
enum class Bias { lowest, highest };

double shift_m_s(const SpeedPosterior& posterior, Bias bias) {
    return bias == Bias::lowest ? -posterior.bias_limit_m_s : posterior.bias_limit_m_s;
}

Difference difference(const SpeedPosterior& posterior, const Threshold& threshold, Bias bias) {
    require_finite(posterior.speed_m_s, "speed (m/s)");
    require_finite(threshold.speed_m_s, "required speed (m/s)");
    require_finite(posterior.bias_limit_m_s, "limit of the bias (m/s)");
    if (posterior.bias_limit_m_s < 0.0)
        fail(fmt::format("the limit of the bias {} m/s is negative", posterior.bias_limit_m_s),
             "Give what a systematic error is at most");
    // The difference from the witnesses counts only on its own side.
    const double difference_m_s = posterior.evidence ? posterior.evidence->difference_m_s : 0.0;
    const bool on_that_side =
        difference_m_s == 0.0 || (bias == Bias::lowest) == (difference_m_s > 0.0);
    const double uncertainty_m_s =
        on_that_side ? posterior.standard_uncertainty_m_s
                     : std::sqrt(std::max(0.0, std::pow(posterior.standard_uncertainty_m_s, 2) -
                                                   std::pow(difference_m_s, 2)));
    const std::array<InputQuantity, 2> inputs{
        InputQuantity{.standard_uncertainty = uncertainty_m_s,
                      .sensitivity = 1.0,
                      .degrees_of_freedom = posterior.effective_degrees_of_freedom},
        InputQuantity{.standard_uncertainty = threshold.standard_uncertainty_m_s,
                      .sensitivity = -1.0}};
    const CombinedUncertainty combined = combine(inputs);
    const double location_m_s =
        posterior.speed_m_s - threshold.speed_m_s + shift_m_s(posterior, bias);
    const bool equal = std::abs(location_m_s) <= kBinaryNoise * std::abs(threshold.speed_m_s);
    return {.location_m_s = equal ? 0.0 : location_m_s,
            .scale_m_s = combined.standard_uncertainty,
            .degrees_of_freedom = combined.effective_degrees_of_freedom};
}

/// The probabilities that the speed reaches the threshold, and that it does not. Neither is
/// computed as 1 minus the other, which would lose the digits of a small one.
struct Tails {
    double not_below = 0.0, below = 0.0;
};

Tails tails_of(const Difference& d) {
    if (d.scale_m_s == 0.0) {
        const bool reaches = d.location_m_s >= 0.0;
        return {.not_below = reaches ? 1.0 : 0.0, .below = reaches ? 0.0 : 1.0};
    }
    const double t = d.location_m_s / d.scale_m_s;
    return {.not_below = student_t_cdf(t, d.degrees_of_freedom),
            .below = student_t_cdf(-t, d.degrees_of_freedom)};
}

/// The same by Student's t, and by the mixture if there is evidence for one.
struct BothTails {
    Tails by_uncertainty = {};
    std::optional<Tails> by_faults = std::nullopt;

    double larger(double Tails::*tail) const {
        return std::max(by_uncertainty.*tail, by_faults ? *by_faults.*tail : 0.0);
    }
};

BothTails tails_of(const SpeedPosterior& posterior, const Threshold& threshold, Bias bias) {
    BothTails found{.by_uncertainty = tails_of(difference(posterior, threshold, bias))};
    if (!posterior.evidence) return found;
    const SpeedMixture mixture =
        mixture_of(*posterior.evidence, posterior.speed_m_s, WitnessSet::all);
    const double speed_m_s = threshold.speed_m_s - shift_m_s(posterior, bias);
    const double u_m_s = threshold.standard_uncertainty_m_s;
    found.by_faults = Tails{.not_below = mixture.probability_not_below(speed_m_s, u_m_s),
                            .below = mixture.probability_below(speed_m_s, u_m_s)};
    return found;
}

void require_positive(double value, const char* name) {
    if (!(value > 0.0 && std::isfinite(value)))
        throw Failure("margin", fmt::format("the {} is {}", name, value),
                      "Give a finite number above 0");
}

void require_not_negative(double value, const char* name) {
    if (!(value >= 0.0 && std::isfinite(value)))
        throw Failure("margin", fmt::format("the {} is {}", name, value),
                      "Give a finite number, 0 or more");
}

struct SpeedToReach {
    double speed_m_s = 0.0;
    double derivative = 1.0;  ///< with respect to the speed to which the margin is added
};

SpeedToReach faster_over_the_course(const MarginRule& rule, double speed_m_s) {
    require_positive(rule.distance_m, "length of the course (m)");
    const double record_s = rule.distance_m / speed_m_s;
    if (!(rule.value < record_s))
        throw Failure("margin",
                      fmt::format("{} s are to be gained on a record of {:.3f} s over {} m",
                                  rule.value, record_s, rule.distance_m),
                      "Check the record's unit and the course's length");
    const double to_reach_m_s = rule.distance_m / (record_s - rule.value);
    const double gain = to_reach_m_s / speed_m_s;
    return {.speed_m_s = to_reach_m_s, .derivative = gain * gain};
}

SpeedToReach above(const MarginRule& rule, double speed_m_s) {
    switch (rule.kind) {
        case MarginKind::absolute:
            return {.speed_m_s = speed_m_s + rule.value, .derivative = 1.0};
        case MarginKind::relative:
            return {.speed_m_s = speed_m_s * (1.0 + rule.value), .derivative = 1.0 + rule.value};
        case MarginKind::elapsed_time:
            break;
    }
    return faster_over_the_course(rule, speed_m_s);
}

}  // namespace

Threshold threshold_of(const MarginRule& rule, const StandingRecord& record) {
    require_positive(record.speed_m_s, "standing record (m/s)");
    require_not_negative(record.expanded_uncertainty_m_s, "record's expanded uncertainty (m/s)");
    require_not_negative(rule.value, "margin");
    const double upper_m_s = record.speed_m_s + record.expanded_uncertainty_m_s;
    const SpeedToReach exact = above(rule, rule.above_upper_limit ? upper_m_s : record.speed_m_s);
    const double standard_uncertainty_m_s =
        rule.above_upper_limit
            ? 0.0
            : exact.derivative * record.expanded_uncertainty_m_s / usual_coverage_factor;
    require_positive(exact.speed_m_s, "required speed (m/s)");
    return {.speed_m_s =
                rule.rounding ? rounded_speed(exact.speed_m_s, *rule.rounding) : exact.speed_m_s,
            .standard_uncertainty_m_s = standard_uncertainty_m_s};
}

double rounded_speed(double speed_m_s, const DecimalRounding& rounding) {
    if (!(speed_m_s >= 0.0 && std::isfinite(speed_m_s)))
        throw Failure("rounding", fmt::format("the speed is {} m/s", speed_m_s),
                      "Give a finite speed, 0 or more");
    if (!(rounding.unit_m_s > 0.0 && std::isfinite(rounding.unit_m_s)))
        throw Failure("rounding", fmt::format("the unit is {} m/s", rounding.unit_m_s),
                      "Give the metres per second in a unit");
    if (rounding.decimals < 0 || rounding.decimals > kMostDecimals)
        throw Failure("rounding", fmt::format("{} decimals", rounding.decimals),
                      fmt::format("Give 0 to {}", kMostDecimals));
    const double scale = power_of_ten(rounding.decimals);
    const double steps = speed_m_s / rounding.unit_m_s * scale;
    const double tolerance = std::min(2e-12 * steps, 5e-7);
    return whole_steps(steps, tolerance, rounding.mode) / scale * rounding.unit_m_s;
}

Conformance conformance(const SpeedPosterior& posterior, const Threshold& threshold) {
    const BothTails tails = tails_of(posterior, threshold, Bias::lowest);
    Conformance found{.by_uncertainty = tails.by_uncertainty.not_below};
    if (tails.by_faults) found.by_faults = tails.by_faults->not_below;
    return found;
}

double conformance_probability(const SpeedPosterior& posterior, const Threshold& threshold) {
    return conformance(posterior, threshold).smaller();
}

Outcome decide(double probability, double level) {
    require_level(level);
    if (!(probability >= 0.0 && probability <= 1.0))
        fail(fmt::format("the probability {} is not in [0, 1]", probability),
             "Give a conformance probability");
    if (probability >= level) return Outcome::beaten;
    return probability <= 1.0 - level ? Outcome::not_beaten : Outcome::not_proven;
}

Outcome decide(const SpeedPosterior& posterior, const Threshold& threshold, double level) {
    if (decide(conformance(posterior, threshold).smaller(), level) == Outcome::beaten)
        return Outcome::beaten;
    const double highest = tails_of(posterior, threshold, Bias::highest).larger(&Tails::not_below);
    return decide(highest, level) == Outcome::not_beaten ? Outcome::not_beaten
                                                         : Outcome::not_proven;
}

double acceptance_limit(const SpeedPosterior& posterior, const Threshold& threshold, double level) {
    require_level(level);
    const Difference d = difference(posterior, threshold, Bias::lowest);
    const double unbiased_m_s = threshold.speed_m_s + posterior.bias_limit_m_s;
    // The upper quantile by symmetry from the lower tail, which keeps its digits.
    const double by_uncertainty_m_s =
        d.scale_m_s == 0.0
            ? unbiased_m_s
            : unbiased_m_s - student_t_quantile(1.0 - level, d.degrees_of_freedom) * d.scale_m_s;
    if (!posterior.evidence) return by_uncertainty_m_s;
    const SpeedMixture mixture = mixture_of(*posterior.evidence, posterior.speed_m_s,
                                            WitnessSet::all, threshold.standard_uncertainty_m_s);
    return std::max(by_uncertainty_m_s,
                    unbiased_m_s + posterior.speed_m_s - mixture.quantile(1.0 - level));
}

double decision_risk(const SpeedPosterior& posterior, const Threshold& threshold, Outcome outcome) {
    return outcome == Outcome::beaten
               ? tails_of(posterior, threshold, Bias::lowest).larger(&Tails::below)
               : tails_of(posterior, threshold, Bias::highest).larger(&Tails::not_below);
}

}  // namespace runcert
