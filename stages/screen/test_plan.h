#pragma once

#include <cstdint>
#include <vector>

namespace runcert {

/// The size of every test of a recording and what follows from it.
class TestPlan {
  public:
    /// `tests` are all that a recording will see: each has the size family_false_alarm_rate /
    /// tests, so that all together raise a false alarm with at most the family-wise rate, however
    /// they depend on one another (Bonferroni).
    ///
    /// `manoeuvre_max_m_s2`: a larger change of acceleration is no motion of the craft.
    TestPlan(double family_false_alarm_rate, std::int64_t tests, double power,
             std::int64_t burst_epochs_max, double manoeuvre_max_m_s2 = 0.0);

    std::int64_t tests() const { return tests_; }
    double size() const { return size_; }
    double power() const { return power_; }
    std::size_t burst_epochs_max() const { return burst_epochs_max_; }
    double manoeuvre_max_m_s2() const { return manoeuvre_max_m_s2_; }
    TestPlan without_manoeuvres() const {
        TestPlan plan = *this;
        plan.manoeuvre_max_m_s2_ = 0.0;
        return plan;
    }

    /// What a statistic of so many degrees of freedom is compared with. Kept once worked out: for
    /// 1 and 2 degrees from the beginning, so that threads may ask for these of one plan; for
    /// others each takes a copy of it.
    double critical(int degrees_of_freedom) const;

    /// The non-centrality that a test of `axes` unknowns finds with the power.
    double noncentrality(int axes) const { return noncentrality_[static_cast<std::size_t>(axes)]; }

  private:
    std::int64_t tests_;
    double size_;
    double power_;
    std::size_t burst_epochs_max_;
    double manoeuvre_max_m_s2_;
    mutable std::vector<double> critical_;
    std::vector<double> noncentrality_;
};

/// Lengths of the spans over which the innovations are tested together, epochs.
inline constexpr std::size_t span_lengths[] = {5, 20, 100};

/// How many tests one epoch sees: an outlier, bursts of every length, a step, a ramp, a manoeuvre
/// and a shift of the stamps, the spans; each for both groups of axes and twice for the other
/// receiver; velocities and limits.
std::int64_t tests_of_an_epoch(std::int64_t burst_epochs_max);

}  // namespace runcert
