#pragma once

#include <memory>
#include <vector>

#include "stages/screen/sections.h"
#include "stages/screen/stretch_tests.h"

namespace runcert {

/// A hypothesis that was accepted, of epochs `first` to `last` of an arc; a step, ramp or shift of
/// the stamps begins with `first`.
struct ScreeningDecision {
    Hypothesis hypothesis = Hypothesis::outlier;
    std::size_t first = 0;
    std::size_t last = 0;
    double statistic = 0.0;
    double threshold = 0.0;
    EstimatedError estimated;
    double sigma_rate_m_s = 0.0;  ///< of a ramp's rate, in the direction in which it is largest
};

/// A decision, or none, as nearly all epochs have: it takes the place of a pointer there.
class OptionalDecision {
  public:
    OptionalDecision& operator=(const ScreeningDecision& decision) {
        decision_ = std::make_unique<ScreeningDecision>(decision);
        return *this;
    }
    explicit operator bool() const { return decision_ != nullptr; }
    const ScreeningDecision& operator*() const { return *decision_; }
    ScreeningDecision* operator->() { return decision_.get(); }
    const ScreeningDecision* operator->() const { return decision_.get(); }
    void reset() { decision_.reset(); }

  private:
    std::unique_ptr<ScreeningDecision> decision_;
};

/// What was decided of an arc, epoch by epoch.
struct ArcDecisions {
    explicit ArcDecisions(std::size_t epochs)
        : left_out(epochs), breaks(epochs), manoeuvres_m_s2(epochs, 0.0) {}

    std::vector<OptionalDecision> left_out;  ///< the measurement is not used
    std::vector<OptionalDecision> breaks;    ///< a step, ramp or shift begins here
    /// By how much (m/s^2) the craft's acceleration changes before the epoch, where it changes more
    /// than the model has it.
    std::vector<double> manoeuvres_m_s2;
    std::int64_t passes = 0;
};

/// The stretches that decisions leave; they begin and end with a measurement.
template <int Axes>
std::vector<TestedStretch<Axes>> stretches_of(const std::vector<ArcEpoch<Axes>>& arc,
                                              const EstimationModel& model,
                                              const ArcDecisions& decisions);

/// Detection, identification, adaptation along an arc without a gap (every epoch measured): tests
/// every hypothesis at every epoch, accepts the best supported ones (smallest tail probability;
/// of equals the simplest) that are far enough apart not to disturb one another, and repeats until
/// the model is accepted; sets of neighbouring outliers are tested together, so that they cannot
/// hide one another. What is left out or broken is tested once more at the end, given all other
/// decisions, and taken back where it need not have been. A span that fails the overall test
/// without a hypothesis that explains it is left out (Hypothesis::model). One hypothesis is no
/// error: where a change of the craft's acceleration is the best supported, the model is given that
/// much more motion there, and nothing is left out. Long stretches are tested in sections that take
/// in so much of their neighbours that nothing beyond counts.
template <int Axes>
ArcDecisions adapt(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
                   const TestPlan& plan, std::size_t section_epochs = epochs_of_section);

}  // namespace runcert
