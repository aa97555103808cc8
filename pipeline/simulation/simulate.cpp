#include "simulation/simulate.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"

namespace runcert {
namespace {

void require_valid(const SimulationSpec& spec) {
    require_valid(spec.run);
    if (spec.duration_ms <= 0 || spec.interval_ms <= 0)
        throw Failure("simulation", "the duration or the interval of the epochs is not positive",
                      "Give both in whole milliseconds");
    for (const ErrorSigmas& sigmas : {spec.white, spec.correlated})
        if (!(sigmas.horizontal_m >= 0.0 && sigmas.vertical_m >= 0.0))
            throw Failure("simulation", "a standard deviation is negative or no number",
                          "Give standard deviations of 0 or more");
    if (!(spec.correlation_time_s > 0.0))
        throw Failure("simulation", "the correlation time is not positive",
                      "Give the time in which the correlation falls by e");
}

/// White noise and first-order Gauss-Markov error, one epoch after the other.
class ErrorSequence {
  public:
    explicit ErrorSequence(const SimulationSpec& spec)
        : random_(spec.seed), white_(axes(spec.white)), correlated_(axes(spec.correlated)) {
        // [YSM22], first-order Gauss-Markov: phi = exp(-dt / tau), q = sigma^2 (1 - phi^2).
        const double steps =
            static_cast<double>(spec.interval_ms) / 1000.0 / spec.correlation_time_s;
        phi_ = std::exp(-steps);
        root_q_over_sigma_ = std::sqrt(-std::expm1(-2.0 * steps));
    }

    Eigen::Vector3d next() {
        const Eigen::Vector3d white = white_.cwiseProduct(draw());
        const Eigen::Vector3d fresh = draw();
        // The first is of the steady state, so that the sequence has no beginning.
        state_ = first_ ? fresh : Eigen::Vector3d(phi_ * state_ + root_q_over_sigma_ * fresh);
        first_ = false;
        return white + correlated_.cwiseProduct(state_);
    }

  private:
    static Eigen::Vector3d axes(const ErrorSigmas& sigmas) {
        return {sigmas.horizontal_m, sigmas.horizontal_m, sigmas.vertical_m};
    }
    Eigen::Vector3d draw() {
        Eigen::Vector3d deviates;
        for (double& deviate : deviates)
            deviate = random_.normal();
        return deviates;
    }

    RandomGenerator random_;
    Eigen::Vector3d white_;
    Eigen::Vector3d correlated_;
    double phi_ = 0.0;
    double root_q_over_sigma_ = 0.0;
    Eigen::Vector3d state_ = Eigen::Vector3d::Zero();  ///< of unit standard deviation
    bool first_ = true;
};

bool any_contains(const std::vector<TimeStretch>& stretches, double time_s) {
    return std::any_of(stretches.begin(), stretches.end(),
                       [&](const TimeStretch& stretch) { return stretch.contains(time_s); });
}

Eigen::Vector3d displacement_by(const Faults& faults, const SimulatedEpoch& epoch) {
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    for (const OutlierFault& outlier : faults.outliers)
        if (outlier.epoch == epoch.epoch) enu_m += outlier.enu_m;
    for (const StepFault& step : faults.steps)
        if (epoch.time_s() >= step.time_s) enu_m += step.enu_m;
    for (const RampFault& ramp : faults.ramps)
        enu_m +=
            std::clamp(epoch.time_s() - ramp.from_s, 0.0, ramp.to_s - ramp.from_s) * ramp.enu_m_s;
    return enu_m;
}

}  // namespace

std::vector<SimulatedEpoch> simulate(const SimulationSpec& spec) {
    require_valid(spec);
    const Eigen::Vector3d travel(std::sin(spec.bearing.radians()), std::cos(spec.bearing.radians()),
                                 0.0);
    ErrorSequence errors(spec);
    std::vector<SimulatedEpoch> epochs;
    epochs.reserve(static_cast<std::size_t>(spec.duration_ms / spec.interval_ms) + 1);
    for (std::int64_t time_ms = 0; time_ms <= spec.duration_ms; time_ms += spec.interval_ms) {
        SimulatedEpoch epoch{.epoch = static_cast<std::int64_t>(epochs.size()) + 1,
                             .time_ms = time_ms};
        epoch.truth = logistic_run(spec.run, epoch.time_s());
        epoch.true_enu_m = spec.start_enu_m + epoch.truth.distance_m * travel;
        epoch.measured_enu_m =
            epoch.true_enu_m + errors.next() + displacement_by(spec.faults, epoch);
        epoch.fixed = !any_contains(spec.faults.float_fixes, epoch.time_s());
        epoch.recorded = !any_contains(spec.faults.gaps, epoch.time_s());
        epochs.push_back(epoch);
    }
    return epochs;
}

}  // namespace runcert
