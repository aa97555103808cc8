#include "stages/window/reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "motion/chain.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

/// The model of screening's tests on these axes. Null if there is none.
template <int Axes>
const ScreeningModel* tested_model(const ScreenedTable& screened) {
    const auto found =
        std::ranges::find(screened.basis.models, tested_axes<Axes>, &ScreeningModel::axes);
    return found == screened.basis.models.end() ? nullptr : &*found;
}

/// The stretch's epochs with the covariances and the motion model of screening's tests.
template <int Axes>
std::vector<ArcEpoch<Axes>> tested_epochs(const ScreenedTable& screened, const Arc<Axes>& arc,
                                          const WindowStretch<Axes>& stretch) {
    std::vector<ArcEpoch<Axes>> epochs = stretch.epochs;
    const EstimationModel model = model_of(*tested_model<Axes>(screened));
    const auto factors = kind_factors(screened.basis, tested_axes<Axes>);
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[arc.rows[stretch.first + i]];
        epochs[i].jerk_factor = 1.0;
        if (i > 0 && manoeuvre_before<Axes>(row) > 0.0)
            allow_manoeuvre(epochs[i - 1], manoeuvre_before<Axes>(row), model, epochs[i]);
        const auto factor = factors.find(row.fix);
        if (factor != factors.end() && epochs[i].measurement)
            epochs[i].measurement->covariance *= factor->second;
    }
    return epochs;
}

/// Keeps the error that moves the speed most, for one hypothesis.
class Worst {
  public:
    Worst(Hypothesis hypothesis, std::string unit)
        : error_{.hypothesis = hypothesis, .unit = std::move(unit)} {}

    /// `effect` is the change of the speed for a unit error in each direction.
    template <int Size>
    void consider(const ScoreTest<Size>& test, double noncentrality,
                  const Eigen::Matrix<double, Size, 1>& effect, std::size_t first,
                  std::size_t last) {
        // Below this the error moves the speed by less than 1 um/s per metre.
        constexpr double nothing = 1e-6;
        if (effect.norm() < nothing) return;
        const Eigen::Matrix<double, Size, 1> worst = test.covariance() * effect;
        double speed_m_s = std::sqrt(noncentrality * effect.dot(worst));
        double size = speed_m_s > 0.0 ? noncentrality * worst.norm() / speed_m_s : 0.0;
        constexpr double without_limit = 1e6;
        if (!(speed_m_s <= without_limit)) speed_m_s = size = without_limit;
        // Errors at the two ends of a window often change its speed alike: which of them is named
        // must not depend on the processor's last bits.
        constexpr double clearly = 1.0 + 1e-9;
        if (speed_m_s <= clearly * error_.speed_m_s) return;
        error_.speed_m_s = speed_m_s;
        error_.size = size;
        first_ = first;
        last_ = last;
    }

    template <int Axes>
    UndetectedError result(const ScreenedTable& screened, const Arc<Axes>& arc,
                           const WindowStretch<Axes>& stretch) const {
        UndetectedError error = error_;
        error.epoch = screened.rows[arc.rows[stretch.first + first_]].epoch;
        error.last_epoch = screened.rows[arc.rows[stretch.first + last_]].epoch;
        return error;
    }

  private:
    UndetectedError error_;
    std::size_t first_ = 0;
    std::size_t last_ = 0;
};

}  // namespace

template <int Axes>
std::vector<UndetectedError> undetected_errors(const ScreenedTable& screened, const Arc<Axes>& arc,
                                               const WindowStretch<Axes>& stretch,
                                               std::span<const PositionVector<Axes>> weights) {
    using Position = PositionVector<Axes>;
    const ScreeningModel* const tested = tested_model<Axes>(screened);
    if (tested == nullptr) return {};
    const std::vector<ArcEpoch<Axes>> epochs = tested_epochs(screened, arc, stretch);
    const Chain<Axes> diagnosis(epochs, model_of(*tested));
    const double of_one = noncentrality(screened.basis.test_size, screened.basis.power, 1);
    const double of_all = noncentrality(screened.basis.test_size, screened.basis.power, Axes);
    const auto factor = [&](std::size_t k) {
        return screened.rows[arc.rows[stretch.first + k]].local_variance_factor.value_or(1.0);
    };

    Worst outlier(Hypothesis::outlier, "m");
    Worst burst(Hypothesis::burst, "m");
    Worst step(Hypothesis::step, "m");
    Worst ramp(Hypothesis::ramp, "m / s");
    Worst time_shift(Hypothesis::time_shift, "s");
    // Effects of a constant error, and of one that grows, of all measurements from an epoch on.
    std::vector<Position> constant(epochs.size() + 1, Position::Zero());
    Position growing = Position::Zero();
    double late = 0.0;
    for (std::size_t k = epochs.size(); k-- > 0;) {
        if (k + 1 < epochs.size())
            growing += constant[k + 1] * (epochs[k + 1].time_s - epochs[k].time_s);
        constant[k] = constant[k + 1] + weights[k];
        if (epochs[k].measurement) {
            outlier.consider(diagnosis.outlier(k), of_all * factor(k), weights[k], k, k);
            late -= weights[k].dot(diagnosis.mean(k).template segment<Axes>(Axes));
        }
        if (k == 0) continue;
        step.consider(diagnosis.step(k), of_all * factor(k), constant[k], k, k);
        if (const auto test = diagnosis.time_shift(k))
            time_shift.consider(*test, of_one * factor(k), Eigen::Matrix<double, 1, 1>(late), k, k);
        ramp.consider(diagnosis.ramp(k), of_all * factor(k), growing, k, k);
    }
    const auto longest = static_cast<std::size_t>(screened.basis.burst_epochs_max);
    diagnosis.for_each_burst(longest, [&](std::size_t k, std::size_t length, const auto& test) {
        burst.consider(test, of_all * factor(k), Position(constant[k] - constant[k + length]), k,
                       k + length - 1);
    });

    std::vector<UndetectedError> errors;
    for (const Worst* worst : {&outlier, &burst, &step, &ramp, &time_shift})
        errors.push_back(worst->result(screened, arc, stretch));
    // Compares at written precision. A step before the last epoch is equivalent to an outlier of
    // it, and the order of the two must not depend on the processor's last bits.
    const auto written = [](const UndetectedError& error) {
        constexpr double per_m_s = 1e6;
        return std::llround(error.speed_m_s * per_m_s);
    };
    std::stable_sort(errors.begin(), errors.end(),
                     [&](const UndetectedError& a, const UndetectedError& b) {
                         return written(a) > written(b);
                     });
    return errors;
}

template std::vector<UndetectedError> undetected_errors<1>(const ScreenedTable&, const Arc<1>&,
                                                           const WindowStretch<1>&,
                                                           std::span<const PositionVector<1>>);
template std::vector<UndetectedError> undetected_errors<2>(const ScreenedTable&, const Arc<2>&,
                                                           const WindowStretch<2>&,
                                                           std::span<const PositionVector<2>>);

}  // namespace runcert
