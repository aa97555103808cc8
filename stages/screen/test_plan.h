#pragma once

#include <cstdint>
#include <vector>

namespace runcert {

/// The size of every test of a recording, and the quantities derived from it.
class TestPlan {
  public:
    /// `tests` is the number of all tests on a recording. Each has the size
    /// family_false_alarm_rate / tests, so that all together raise a false alarm with at most the
    /// family-wise rate, whatever their dependence (Bonferroni).
    ///
    /// A change of acceleration larger than `manoeuvre_max_m_s2` is not a motion of the craft.
    TestPlan(double family_false_alarm_rate, std::int64_t tests, double power,
             std::int64_t burst_epochs_max, double manoeuvre_max_m_s2 = 0.0);

    std::int64_t tests() const { return tests_; }
    double size() const { return size_; }
    double power() const { return power_; }
    std::size_t burst_epochs_max() const { return burst_epochs_max_; }
    double manoeuvre_max_m_s2() const { return manoeuvre_max_m_s2_; }
    TestPlan with_manoeuvres(double max_m_s2) const {
        TestPlan plan = *this;
        plan.manoeuvre_max_m_s2_ = max_m_s2;
        return plan;
    }

    /// The critical value of a statistic with `degrees_of_freedom`. Values are cached. Those for 1
    /// and 2 degrees exist from the start, so that threads may share a plan for them; for others
    /// each thread needs its own copy.
    double critical(int degrees_of_freedom) const;

    /// The non-centrality that a test of `axes` unknowns detects with the power.
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

/// Numbers of epochs in the spans over which the innovations are tested jointly.
inline constexpr std::size_t span_lengths[] = {5, 20, 100};

/// What a recording has to be tested: how many of each at every epoch.
struct TestedData {
    std::int64_t position_series = 2;  ///< horizontal, and vertical where heights were measured
    std::int64_t baseline_series = 0;  ///< between two antennas: across, and in length
    std::int64_t speed_series = 0;     ///< recorded speeds: horizontal, and vertical rates
    std::int64_t comparisons = 0;      ///< with witnesses, the surface, and limits that are set
};

/// Number of tests on one epoch. Each series is tested for an outlier, bursts of every length, a
/// step, a ramp, a manoeuvre, a shift of the stamps, and over the spans.
std::int64_t tests_of_an_epoch(const TestedData& data, std::int64_t burst_epochs_max);

}  // namespace runcert
