#pragma once

#include <span>
#include <vector>

// All that is known of one speed from several sources, each of which may be at fault: one vector of
// their speeds y, one covariance S of their errors, and the hypotheses "all are sound" and "source
// j is at fault" ([PPC98], [JCGM106] 7). With the true speed v, a fault f, and e_j that is 1 at j:
//
//   y = 1 v + f e_j + errors,   S_ik = [i = k] own_i^2 + min(slow_i, slow_k)^2
//   g = S^-1 1 / (1' S^-1 1),   u^2 = g' S g                    least variance ([GUM] F.1.2)
//   v | y, f e_j  ~  N(g' y - f g' e_j, u^2)
//
// Sources that would have a negative weight are left out. What was calibrated by the first source
// has its fault, too: e_0 is 1 there as well.
//
// The differences of the speeds tell who is at fault. What sources may share, or may not, counts on
// the safe side: in S they share it, which makes the variance of any mean largest. In their
// differences they share nothing, which makes the variances of these largest. With w_i the inverse
// of the variance of source i alone, W their sum, m the mean with these weights:
//
//   X = sum w_i (y_i - m)^2,   q_j = e_j' w (1 - e_j' w / W),   f_j = sum_i e_ji w_i (y_i - m) /
//   q_j L(f e_j) = exp(-1/2 (X - q_j f_j^2 + q_j (f - f_j)^2)),   L(sound) = exp(-X / 2)
//
// Each hypothesis has its prior probability times its likelihood. Faults are uniform within their
// limits.

namespace runcert {

/// An undetected fault. A source has one with this probability. Its effect on the speed is uniform
/// between minus and plus the largest (m/s), or between 0 and the largest for a source that can
/// only err upwards.
struct FaultPrior {
    double probability = 0.0;
    double largest_m_s = 0.0;
    bool upwards_alone = false;
};

/// A speed according to one source, m/s. Its errors are normal apart from a fault.
struct SpeedBySource {
    double speed_m_s = 0.0;
    double own_m_s = 0.0;   ///< standard uncertainty by errors that no other source has
    double slow_m_s = 0.0;  ///< by time-correlated errors, which others have as far as theirs reach
    /// False: its time-correlated error is the first source's, so that no difference shows it.
    bool slow_differs = true;
    /// Whether it was calibrated by the first source: a fault of that is then its own, too.
    bool fault_is_common = false;
    FaultPrior fault = {};

    /// Standard uncertainty as a difference from other sources shows it.
    double alone_m_s() const;
};

/// The weighted mean of least variance.
struct MeanSpeed {
    std::vector<double> weights;  ///< not negative; their sum is 1
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
    double slow_m_s = 0.0;     ///< the part of it by time-correlated errors
    double fault_share = 0.0;  ///< weight of all that a fault of the first source moves
};

/// The mean of one or more sources. `fault_m_s` is a standard uncertainty of the first by a rare
/// fault, as root mean square ([GUM] 4.3).
MeanSpeed mean_of(std::span<const SpeedBySource> speeds, double fault_m_s = 0.0);

/// A sum of squares in relation to what chance exceeds once in a thousand: the root of their ratio.
/// Above 1 it is no chance.
double over_chance(double sum_of_squares, int degrees_of_freedom);

/// The same of the differences of all sources. 0 of a single one.
double disagreement(std::span<const SpeedBySource> speeds);

/// Probability of a fault of each source, given their differences. Where no hypothesis explains
/// such differences, it is 1 for the first.
std::vector<double> fault_posteriors(std::span<const SpeedBySource> speeds);

/// The distribution of the true speed given all sources.
class SpeedMixture {
  public:
    /// There must be at least one source. `common_m_s` is the standard uncertainty by errors that
    /// all of them have.
    explicit SpeedMixture(std::span<const SpeedBySource> speeds, double common_m_s = 0.0);

    /// Probability that the true speed is at least, or below, a speed that is itself uncertain
    /// (normal). Both keep their relative accuracy where they are small.
    double probability_not_below(double speed_m_s, double standard_uncertainty_m_s = 0.0) const;
    double probability_below(double speed_m_s, double standard_uncertainty_m_s = 0.0) const;

    /// The speed that the true speed is below with this probability, above 0 and below 1.
    double quantile(double probability) const;

    /// Half the width of the interval about a speed that holds the true one with this probability,
    /// above 0 and below 1.
    double half_width(double speed_m_s, double probability) const;

  private:
    struct Component {
        double weight = 0.0, mean_m_s = 0.0, sigma_m_s = 0.0;
    };
    double tail(double speed_m_s, double standard_uncertainty_m_s, double sign) const;

    std::vector<Component> components_;
    double common_m_s_ = 0.0;
};

}  // namespace runcert
