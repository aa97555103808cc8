#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "core/rounding.h"
#include "schemas/profile/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// A body's rounding of a speed to decimals of its unit; `nearest` takes a half up.
struct DecimalRounding {
    StepRounding mode = StepRounding::nearest;
    double unit_m_s = 1.0;  ///< value of the unit in m/s
    int decimals = 0;       ///< 0 to 9
};

/// A rule's margin over the standing record.
struct MarginRule {
    MarginKind kind = MarginKind::absolute;
    double value = 0.0;       ///< m/s (absolute), a fraction (relative), s (elapsed_time)
    double distance_m = 0.0;  ///< for elapsed_time: length of the course
    /// The margin is added to the record's upper limit, its value plus its expanded uncertainty.
    bool above_upper_limit = false;
    std::optional<DecimalRounding> rounding = std::nullopt;
};

/// The standing record.
struct StandingRecord {
    double speed_m_s = 0.0;
    double expanded_uncertainty_m_s = 0.0;  ///< k = 2; 0 if none is stated
};

/// The required speed.
struct Threshold {
    double speed_m_s = 0.0;
    /// From the record's own. 0 if it has none or its upper limit was used.
    double standard_uncertainty_m_s = 0.0;
};

/// The required speed over a record r (its upper limit, if the rule says so). It is r + value or
/// r (1 + value). Over a course of length D, for which the record took t = D / r, it is
/// D / (t - value). It is then rounded as the body rounds. The uncertainty of r is propagated by
/// the derivative of the speed before rounding ([GUM] 5.1).
///
/// Failure (at "margin") for numbers that are not finite, a record or course not above 0, a
/// negative margin or uncertainty, a time to gain that is not below the record's, or a rounding as
/// below.
Threshold threshold_of(const MarginRule& rule, const StandingRecord& record);

/// A speed (m/s, 0 or more) rounded to decimals of a unit, in m/s.
///
/// A figure that is decimal except for errors of binary fractions counts as that decimal figure:
/// 100 km/h + 0.2 % is 100.20 km/h, which no mode changes. Such errors are differences within 2e-12
/// of the figure (those of conversion and margin are about 1e-15), but at most 5e-7 of the last
/// place. The result is the decimal figure's nearest double times the unit, and so equals the same
/// figure read from text and converted.
///
/// Failure (at "rounding") for numbers that are not finite, a negative speed, a unit not above 0,
/// decimals outside 0 to 9, or a figure of more than 15 digits.
double rounded_speed(double speed_m_s, const DecimalRounding& rounding);

/// The state of knowledge about the speed: Student's t with its location and scale, or the normal
/// distribution where the degrees of freedom are empty ([GUM] G.3, [JCGM106] 7).
///
/// The limit of a systematic error in either direction shifts the location; for a decision the
/// least favourable value in that range is used. With evidence, how much faster the positions are
/// than the weighted mean with the witnesses (negative: slower) is part of the scale; it counts on
/// the less favourable side.
using SpeedPosterior = RuleFigure;

/// P(speed >= threshold) by the posterior's Student's t, and by the mixture if there is one.
struct Conformance {
    double by_uncertainty = 0.0;
    std::optional<double> by_faults = std::nullopt;

    double smaller() const { return std::min(by_uncertainty, by_faults.value_or(1.0)); }
};

/// P(speed >= threshold): Phi((y - T) / u) in the normal case ([JCGM106] 7.3), where y is the
/// lowest location that the bias allows. A difference from the witnesses counts only if they are
/// slower.
///
/// The threshold's own uncertainty is independent and normal, and is combined with the speed's.
/// Student's t of the combination has the degrees of freedom of Welch and Satterthwaite ([GUM]
/// (G.2b)). That is exact for normal distributions. With an uncertain threshold and few degrees of
/// freedom, it overstates a probability near 0.95: by up to 0.005 for 10, and 0.02 for 3.
///
/// Without any uncertainty the probability is 0 or 1, and a speed equal to the threshold reaches
/// it. Speeds that differ only by errors of binary fractions (kBinaryNoise) are equal. Failure (at
/// "decision" or "uncertainty budget") for numbers that are not finite, a negative uncertainty, or
/// degrees of freedom not above 0.
Conformance conformance(const SpeedPosterior& posterior, const Threshold& threshold);

/// The smaller of the two conformance probabilities.
double conformance_probability(const SpeedPosterior& posterior, const Threshold& threshold);

/// Guarded acceptance and guarded rejection ([JCGM106] 8.3): beaten where the probability is at
/// least `level`, not beaten where it is at most 1 - level, otherwise not proven. Failure (at
/// "decision") unless 0 <= probability <= 1 and 0.5 < level < 1.
Outcome decide(double probability, double level);

/// The decision on a speed: beaten with the bias at its lowest and the smaller probability, not
/// beaten with it at its highest and the larger probability.
Outcome decide(const SpeedPosterior& posterior, const Threshold& threshold, double level);

/// The acceptance limit: the smallest speed (m/s) that would be accepted with this uncertainty. It
/// is the threshold plus the bias's limit and a guard band, the one-sided quantile at `level` times
/// the combined standard uncertainty ([JCGM106] 8.3). If higher, it is the speed at which the
/// shifted mixture reaches the level. The posterior's speed is not used. Failure as for
/// `conformance`.
double acceptance_limit(const SpeedPosterior& posterior, const Threshold& threshold, double level);

/// Probability that the decision is incorrect for this speed ([JCGM106] 9, specific risks). If the
/// outcome is beaten, it is the probability that the speed is below the threshold. Otherwise the
/// speed is refused, and it is the probability that it reaches the threshold. The larger of the two
/// kinds of probability is taken. It keeps its relative accuracy however small it is. Failure as
/// for `conformance`.
double decision_risk(const SpeedPosterior& posterior, const Threshold& threshold, Outcome outcome);

}  // namespace runcert
