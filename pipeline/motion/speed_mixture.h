#pragma once

#include <optional>
#include <vector>

// Knowledge of a speed whose measurements may be at fault: hypotheses with prior probabilities, and
// the speed under each ([PPC98], [JCGM106] 7).

namespace runcert {

/// An undetected fault. A source has one with this probability. Its effect on the speed is uniform
/// between minus and plus the largest (m/s), or between 0 and the largest for a source that can
/// only err upwards.
struct FaultPrior {
    double probability = 0.0;
    double largest_m_s = 0.0;
    bool upwards_alone = false;
};

/// A speed according to one source (m/s), with normal errors apart from a fault.
struct SpeedBySource {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;  ///< above 0
    FaultPrior fault = {};
};

/// The distribution of the true speed given the positions and, if there is one, an independent
/// witness. It is a mixture of three hypotheses. If neither is at fault, the speed is the weighted
/// mean of both. If the positions are, it is the witness's speed, as far as their largest fault
/// allows. If the witness is, it is the speed of the positions.
///
/// Each hypothesis has its prior probability times the likelihood of the difference between the
/// two. Without a witness only the first two remain.
class SpeedMixture {
  public:
    /// `shared_m_s` is the standard uncertainty of errors that affect both sources alike, so that
    /// their difference does not show them.
    SpeedMixture(const SpeedBySource& positions, const std::optional<SpeedBySource>& witness,
                 double shared_m_s = 0.0);

    /// Probability that the positions, or the witness, are at fault, given their comparison.
    double positions_at_fault() const { return positions_at_fault_; }
    double witness_at_fault() const { return witness_at_fault_; }

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
        double weight = 0.0;
        double mean_m_s = 0.0;
        double sigma_m_s = 0.0;
    };
    void add_alone(const SpeedBySource& positions, double weight);
    void add_positions_at_fault(const SpeedBySource& positions, const SpeedBySource& witness);
    double tail(double speed_m_s, double standard_uncertainty_m_s, double sign) const;

    std::vector<Component> components_;
    double shared_m_s_ = 0.0;
    double positions_at_fault_ = 0.0;
    double witness_at_fault_ = 0.0;
};

}  // namespace runcert
