#pragma once

#include <memory>
#include <vector>

#include "motion/sections.h"
#include "stages/screen/stretch_tests.h"

namespace runcert {

/// A hypothesis accepted for epochs `first` to `last` of an arc. A step, ramp or shift of the
/// stamps begins with `first`.
struct ScreeningDecision {
    Hypothesis hypothesis = Hypothesis::outlier;
    std::size_t first = 0;
    std::size_t last = 0;
    double statistic = 0.0;
    double threshold = 0.0;
    EstimatedError estimated;
    double sigma_rate_m_s = 0.0;  ///< of a ramp's rate, in the direction in which it is largest
};

/// A decision, or none. Nearly all epochs have none, and then it takes only the space of a pointer.
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

/// The decisions on an arc, epoch by epoch.
struct ArcDecisions {
    explicit ArcDecisions(std::size_t epochs)
        : left_out(epochs), breaks(epochs), manoeuvres_m_s2(epochs, 0.0) {}

    std::vector<OptionalDecision> left_out;  ///< the measurement is not used
    std::vector<OptionalDecision> breaks;    ///< a step, ramp or shift of the stamps begins here
    /// Change of the craft's acceleration (m/s^2) just before the epoch, where it exceeds what the
    /// model allows.
    std::vector<double> manoeuvres_m_s2;
    std::int64_t passes = 0;
};

/// The stretches that remain after the decisions. Each begins and ends with a measurement.
template <int Axes>
std::vector<TestedStretch<Axes>> stretches_of(const std::vector<ArcEpoch<Axes>>& arc,
                                              const EstimationModel& model,
                                              const ArcDecisions& decisions);

/// Detection, identification and adaptation along an arc without a gap (every epoch measured). It
/// tests every hypothesis at every epoch and accepts the best supported ones, with the smallest
/// tail probability, and of equals the simplest. Those accepted together are far enough apart not
/// to disturb one another. It repeats until the model is accepted. Sets of neighbouring outliers
/// are tested together, so that they cannot mask one another.
///
/// At the end each omission or break is tested again, given all other decisions, and withdrawn if
/// unnecessary. A span that fails the overall test, and that no hypothesis explains, is left out
/// (Hypothesis::model).
///
/// One hypothesis is not an error. Where a change of the craft's acceleration is best supported,
/// the model is given that much more motion there, and nothing is left out.
///
/// Long stretches are tested in sections. These include enough of their neighbours that nothing
/// beyond matters.
template <int Axes>
ArcDecisions adapt(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
                   const TestPlan& plan, std::size_t section_epochs = epochs_of_section);

}  // namespace runcert
