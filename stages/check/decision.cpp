#include "stages/check/decision.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/statistics.h"
#include "core/uncertainty.h"

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

/// Student's t of the speed less a limit.
struct Difference {
    double location_m_s = 0.0;
    double scale_m_s = 0.0;
    std::optional<double> degrees_of_freedom = std::nullopt;
};

/// Which place in the range of the bias.
enum class Bias { lowest, none, highest };

Difference difference(const SpeedPosterior& posterior, const Threshold& threshold, Bias bias) {
    require_finite(posterior.speed_m_s, "speed (m/s)");
    require_finite(threshold.speed_m_s, "required speed (m/s)");
    require_finite(posterior.bias_limit_m_s, "limit of the bias (m/s)");
    if (posterior.bias_limit_m_s < 0.0)
        fail(fmt::format("the limit of the bias {} m/s is negative", posterior.bias_limit_m_s),
             "Give what a systematic error is at most");
    const std::array<InputQuantity, 2> inputs{
        InputQuantity{.standard_uncertainty = posterior.standard_uncertainty_m_s,
                      .sensitivity = 1.0,
                      .degrees_of_freedom = posterior.degrees_of_freedom},
        InputQuantity{.standard_uncertainty = threshold.standard_uncertainty_m_s,
                      .sensitivity = -1.0}};
    const CombinedUncertainty combined = combine(inputs);
    const double by_bias = bias == Bias::lowest    ? -posterior.bias_limit_m_s
                           : bias == Bias::highest ? posterior.bias_limit_m_s
                                                   : 0.0;
    const double location_m_s = posterior.speed_m_s - threshold.speed_m_s + by_bias;
    const bool equal = std::abs(location_m_s) <= kBinaryNoise * std::abs(threshold.speed_m_s);
    return {.location_m_s = equal ? 0.0 : location_m_s,
            .scale_m_s = combined.standard_uncertainty,
            .degrees_of_freedom = combined.effective_degrees_of_freedom};
}

double probability_not_below_zero(const Difference& d) {
    if (d.scale_m_s == 0.0) return d.location_m_s >= 0.0 ? 1.0 : 0.0;
    return student_t_cdf(d.location_m_s / d.scale_m_s, d.degrees_of_freedom);
}

/// Not 1 less the other, which would lose the digits of a small one.
double probability_below_zero(const Difference& d) {
    if (d.scale_m_s == 0.0) return d.location_m_s >= 0.0 ? 0.0 : 1.0;
    return student_t_cdf(-d.location_m_s / d.scale_m_s, d.degrees_of_freedom);
}

}  // namespace

double conformance_probability(const SpeedPosterior& posterior, const Threshold& threshold) {
    return probability_not_below_zero(difference(posterior, threshold, Bias::lowest));
}

double conformance_probability(const SpeedPosterior& posterior, double lower_m_s,
                               double upper_m_s) {
    const Difference above_lower = difference(posterior, {.speed_m_s = lower_m_s}, Bias::none);
    const Difference above_upper = difference(posterior, {.speed_m_s = upper_m_s}, Bias::none);
    if (!(lower_m_s <= upper_m_s))
        fail(fmt::format("the lower limit {} is above the upper limit {}", lower_m_s, upper_m_s),
             "Exchange them");
    if (above_lower.scale_m_s == 0.0)
        return above_lower.location_m_s >= 0.0 && above_upper.location_m_s <= 0.0 ? 1.0 : 0.0;
    // Where both limits are below the speed the lower tails are the small ones.
    if (above_upper.location_m_s > 0.0)
        return probability_below_zero(above_upper) - probability_below_zero(above_lower);
    return probability_not_below_zero(above_lower) - probability_not_below_zero(above_upper);
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
    const auto with = [&](Bias bias) {
        return decide(probability_not_below_zero(difference(posterior, threshold, bias)), level);
    };
    if (with(Bias::lowest) == Outcome::beaten) return Outcome::beaten;
    return with(Bias::highest) == Outcome::not_beaten ? Outcome::not_beaten : Outcome::not_proven;
}

double acceptance_limit(const SpeedPosterior& posterior, const Threshold& threshold, double level) {
    require_level(level);
    const Difference d = difference(posterior, threshold, Bias::none);
    const double unbiased_m_s = threshold.speed_m_s + posterior.bias_limit_m_s;
    if (d.scale_m_s == 0.0) return unbiased_m_s;
    // By symmetry the upper quantile, from the tail, which keeps its digits.
    return unbiased_m_s - student_t_quantile(1.0 - level, d.degrees_of_freedom) * d.scale_m_s;
}

double decision_risk(const SpeedPosterior& posterior, const Threshold& threshold, Outcome outcome) {
    return outcome == Outcome::beaten
               ? probability_below_zero(difference(posterior, threshold, Bias::lowest))
               : probability_not_below_zero(difference(posterior, threshold, Bias::highest));
}

}  // namespace runcert
