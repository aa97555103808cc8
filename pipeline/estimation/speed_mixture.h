#pragma once

#include <optional>
#include <vector>

// What is known of a speed where its measurements may be at fault: hypotheses with prior
// probabilities, and what each of them says ([PPC98], [JCGM106] 7).

namespace runcert {

/// An error that nothing found: with this probability a source has one, and its effect on the speed
/// lies anywhere from minus to plus the largest (m/s), or from 0 to it of a source that can err
/// upwards alone.
struct FaultPrior {
    double probability = 0.0;
    double largest_m_s = 0.0;
    bool upwards_alone = false;
};

/// A speed as one source has it (m/s), its errors normal but for a fault.
struct SpeedBySource {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;  ///< above 0
    FaultPrior fault = {};
};

/// The distribution of the true speed by positions, and by a witness that is independent of them
/// where there is one. A mixture of three hypotheses: nobody is at fault, and the speed is the
/// weighted mean of both; the positions are, and it is the witness's, as far as their largest fault
/// allows; the witness is, and it is the positions'. Each counts by its prior probability times
/// what it makes of the difference of the two. Without a witness the first two are what there is.
class SpeedMixture {
  public:
    /// `shared_m_s` is the standard uncertainty of what moves both sources alike, so that their
    /// difference does not show it.
    SpeedMixture(const SpeedBySource& positions, const std::optional<SpeedBySource>& witness,
                 double shared_m_s = 0.0);

    /// Probability that the positions, or the witness, are at fault, after their comparison.
    double positions_at_fault() const { return positions_at_fault_; }
    double witness_at_fault() const { return witness_at_fault_; }

    /// Probability that the true speed is at least, or below, one that itself is uncertain
    /// (normal). Both keep their digits where they are small.
    double probability_not_below(double speed_m_s, double standard_uncertainty_m_s = 0.0) const;
    double probability_below(double speed_m_s, double standard_uncertainty_m_s = 0.0) const;

    /// The speed that the true one is below with this probability, above 0 and below 1.
    double quantile(double probability) const;

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
