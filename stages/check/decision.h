#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "estimation/speed_mixture.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"
#include "stages/check/threshold.h"

namespace runcert {

/// The state of knowledge of the speed: Student's t with this location and scale, the normal
/// distribution where the degrees of freedom are empty ([GUM] G.3, [JCGM106] 7).
struct SpeedPosterior {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
    std::optional<double> degrees_of_freedom = std::nullopt;
    /// A systematic error either way is at most this: it moves the location, and whichever place in
    /// that range is the least favourable to a decision is the one that it is taken at.
    double bias_limit_m_s = 0.0;
    /// Of the standard uncertainty, how much faster the positions are than the weighted mean with
    /// the witnesses; negative where they are slower. What counts of it is the less favourable
    /// side.
    double difference_m_s = 0.0;
    /// What positions and witnesses say, where either may be at fault.
    std::optional<SpeedEvidence> evidence = std::nullopt;
};

/// What the windows of a profile say of the rule's speed; nothing where they are too few.
std::optional<SpeedPosterior> posterior_of(const ProfileWindows& windows);

/// Which witnesses a distribution of the speed rests on: those that have a share in it, or those of
/// them alone that were observed.
enum class WitnessSet { all, observed };

/// The distribution of the speed where positions and witnesses may be at fault, those chosen among
/// rivals as often as that makes it. `also_m_s` is another standard uncertainty that moves all
/// alike. The posterior must have evidence.
SpeedMixture mixture_of(const SpeedPosterior& posterior, WitnessSet heard, double also_m_s = 0.0);

/// P(speed >= threshold) by the posterior's Student's t, and by the mixture where there is one.
struct Conformance {
    double by_uncertainty = 0.0;
    std::optional<double> by_faults = std::nullopt;

    double smaller() const { return std::min(by_uncertainty, by_faults.value_or(1.0)); }
};

/// P(speed >= threshold): Phi((y - T) / u) in the normal case ([JCGM106] 7.3), y being the lowest
/// place that the bias allows. A difference from the witnesses counts where they are slower.
///
/// The threshold's own uncertainty is independent and normal; it is combined with the speed's, and
/// Student's t of the combination has the degrees of freedom of Welch and Satterthwaite ([GUM]
/// (G.2b)). That is exact for normal ones; where the threshold is uncertain and the speed has few
/// degrees it overstates a probability near 0.95 by as much as 0.005 for 10 and 0.02 for 3.
///
/// Without any uncertainty the probability is 0 or 1, and a speed equal to the threshold reaches
/// it; speeds that differ by no more than binary fractions (kBinaryNoise) are equal. Failure (at
/// "decision" or "uncertainty budget") for numbers that are not finite, a negative uncertainty, or
/// degrees of freedom not above 0.
Conformance conformance(const SpeedPosterior& posterior, const Threshold& threshold);

/// The smaller of both.
double conformance_probability(const SpeedPosterior& posterior, const Threshold& threshold);

/// P(lower <= speed <= upper) ([JCGM106] 7.4), both limits known exactly, without a bias. Failure
/// as above, or where lower > upper.
double conformance_probability(const SpeedPosterior& posterior, double lower_m_s, double upper_m_s);

/// Guarded acceptance and guarded rejection ([JCGM106] 8.3): beaten where the probability is at
/// least `level`, not beaten where it is at most 1 - level, else not proven. Failure (at
/// "decision") unless 0 <= probability <= 1 and 0.5 < level < 1.
Outcome decide(double probability, double level);

/// The same of a speed: beaten with the bias at its lowest and the smaller probability, not beaten
/// with it at its highest and the larger one.
Outcome decide(const SpeedPosterior& posterior, const Threshold& threshold, double level);

/// The smallest speed (m/s) that would be accepted with this uncertainty: the threshold and a guard
/// band of the one-sided quantile at `level` times the combined standard uncertainty ([JCGM106]
/// 8.3), and the bias's limit; or that at which the mixture, moved along, reaches the level, where
/// it is higher. The posterior's speed has no part in it. Failure as above.
double acceptance_limit(const SpeedPosterior& posterior, const Threshold& threshold, double level);

/// Probability that the decision is wrong for this speed ([JCGM106] 9, specific risks): that a
/// speed found to be beaten is below the threshold, or that one that is not, so that it is refused,
/// reaches it; the larger of both probabilities. Keeps its digits however small it is. Failure as
/// for conformance.
double decision_risk(const SpeedPosterior& posterior, const Threshold& threshold, Outcome outcome);

}  // namespace runcert
