#include "motion/likelihood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/parallel.h"
#include "motion/chain_kernel.h"

namespace runcert {

double InnovationSums::log_likelihood() const {
    return -0.5 * (statistic + log_determinant);
}

double InnovationSums::log_likelihood_at_best_scale() const {
    const auto n = static_cast<double>(values);
    return -0.5 * (n * std::log(statistic / n) + log_determinant + n);
}

namespace {

/// The logarithm of a product of many factors. It is taken once for as many factors as fit a
/// double's range.
class LogOfProduct {
  public:
    void multiply(double factor) {
        product_ *= factor;
        if (product_ > smallest && product_ < largest) return;
        sum_ += std::log(product_);
        product_ = 1.0;
    }
    double value() const { return sum_ + std::log(product_); }

  private:
    // Within these bounds one more factor stays in range.
    static constexpr double smallest = 1e-150;
    static constexpr double largest = 1e150;
    double product_ = 1.0;
    double sum_ = 0.0;
};

/// One number for each of several models. Two together take less time than one in scalar
/// arithmetic.
constexpr std::size_t models_side_by_side = 2;
using SideBySide = double __attribute__((vector_size(models_side_by_side * sizeof(double))));

/// The forward filters of several models side by side, as far as their likelihood needs them.
/// KalmanFilter is the same filter for one model.
template <int Axes>
class Likelihood {
  public:
    explicit Likelihood(std::span<const EstimationModel> models) : models_(models) {
        for (std::size_t i = 0; i < models_side_by_side; ++i) {
            const double scale = models[i].measurement_scale;
            scale_[i] = scale * scale;
        }
    }

    void add(std::span<const ArcEpoch<Axes>> arc) {
        add(arc, [](std::size_t) {});
    }

    /// Calls `visited(k)` after each epoch.
    template <class Visited>
    void add(std::span<const ArcEpoch<Axes>> arc, const Visited& visited) {
        if (arc.empty()) return;
        begin(arc[0].measurement.value().position);
        UnknownsToTell unknowns;
        for (std::size_t k = 0; k < arc.size(); ++k) {
            if (k > 0) carry(step_kind(arc[k - 1], arc[k]));
            if (arc[k].measurement) {
                take_in(arc[k], !unknowns.determined_by_measurement());
            }
            visited(k);
        }
    }

    InnovationSums sums(std::size_t i) const {
        return {.statistic = statistic_[i],
                .log_determinant = determinants_[i].value(),
                .values = values_};
    }

  private:
    static constexpr int size = state_size<Axes>;
    void begin(const PositionVector<Axes>& position) {
        for (std::size_t i = 0; i < models_side_by_side; ++i) {
            const StateEstimate<Axes> prior = KalmanFilter<Axes>(models_[i]).prior(position);
            for (int row = 0; row < size; ++row) {
                mean_[row][i] = prior.mean(row);
                for (int column = 0; column <= row; ++column)
                    covariance_[row * size + column][i] = prior.covariance(row, column);
            }
        }
    }

    /// Propagates to the next epoch. A step is reused while steps are of one kind. What does not
    /// depend on the jerk density is reused while they have the same length.
    void carry(const StepKind& kind) {
        if (kind != kind_) {
            const bool same_length = kind.length_ns == kind_.length_ns;
            kind_ = kind;
            for (std::size_t i = 0; i < models_side_by_side; ++i) {
                if (!same_length) of_length_[i] = axis_step(models_[i], kind.dt_s());
                kernel::set_numbers(step_, with_jerk(of_length_[i], kind.jerk_factor),
                                    [i](SideBySide& number, double value) { number[i] = value; });
            }
        }
        kernel::carry<Axes>(step_, mean_.data());
        kernel::carry_covariance<Axes>(step_, covariance_.data());
    }

    void take_in(const ArcEpoch<Axes>& epoch, bool counts) {
        const PositionMeasurement<Axes>& measurement = *epoch.measurement;
        const auto white = kernel::whitening_of<Axes>(measurement.covariance);
        if (!white.is_positive_definite())
            require_positive_definite<Axes>(measurement.covariance, epoch.time_s);
        for (int j = 0; j < Axes; ++j) {
            const double measured = kernel::whitened<Axes>(
                white, j, [&](int axis) { return measurement.position(axis); });
            const auto seen = kernel::take_in<Axes, SideBySide>(
                white, j, measured, scale_ * white.variance[j], mean_.data(), covariance_.data());
            if (!counts) continue;
            statistic_ += seen.innovation * seen.innovation / seen.variance;
            for (std::size_t i = 0; i < models_side_by_side; ++i)
                determinants_[i].multiply(seen.variance[i]);
            ++values_;
        }
    }

    std::span<const EstimationModel> models_;
    SideBySide scale_{};
    StepKind kind_;
    std::array<AxisStep, models_side_by_side> of_length_;
    kernel::StepNumbers<SideBySide> step_;
    kernel::Numbers<SideBySide, size> mean_{};
    kernel::Numbers<SideBySide, size * size> covariance_{};
    SideBySide statistic_{};
    std::array<LogOfProduct, models_side_by_side> determinants_;
    std::int64_t values_ = 0;
};

/// Calls `run` with a likelihood of several models side by side and the number of them in use,
/// which returns a list with one entry for each. Returns the entries of all models, in order.
template <int Axes, class Run>
auto for_all_models(std::span<const EstimationModel> models, const Run& run) {
    constexpr std::size_t together = models_side_by_side;
    const auto groups = static_cast<std::int64_t>((models.size() + together - 1) / together);
    auto of_groups = results_of(groups, threads_allowed(), [&](std::int64_t group) {
        const std::size_t first = static_cast<std::size_t>(group) * together;
        const auto wanted = models.subspan(first, std::min(together, models.size() - first));
        std::vector<EstimationModel> models_together(wanted.begin(), wanted.end());
        models_together.resize(together, models_together.back());
        Likelihood<Axes> likelihood(models_together);
        return run(likelihood, wanted.size());
    });
    typename decltype(of_groups)::value_type all;
    for (auto& of_group : of_groups)
        std::ranges::move(of_group, std::back_inserter(all));
    return all;
}

InnovationSums difference(const InnovationSums& later, const InnovationSums& earlier) {
    return {.statistic = later.statistic - earlier.statistic,
            .log_determinant = later.log_determinant - earlier.log_determinant,
            .values = later.values - earlier.values};
}

}  // namespace

template <int Axes>
std::vector<InnovationSums> innovation_sums_of(
    std::span<const std::span<const ArcEpoch<Axes>>> arcs,
    std::span<const EstimationModel> models) {
    return for_all_models<Axes>(models, [&](Likelihood<Axes>& likelihood, std::size_t wanted) {
        for (const std::span<const ArcEpoch<Axes>> arc : arcs)
            likelihood.add(arc);
        std::vector<InnovationSums> sums;
        for (std::size_t i = 0; i < wanted; ++i)
            sums.push_back(likelihood.sums(i));
        return sums;
    });
}

template <int Axes>
std::vector<std::vector<InnovationSums>> innovation_sums_along(
    std::span<const ArcEpoch<Axes>> arc, std::span<const EstimationModel> models,
    std::span<const std::size_t> ends) {
    return for_all_models<Axes>(models, [&](Likelihood<Axes>& likelihood, std::size_t wanted) {
        std::vector<std::vector<InnovationSums>> sums(wanted);
        std::vector<InnovationSums> before(wanted);
        std::size_t stretch = 0;
        likelihood.add(arc, [&](std::size_t k) {
            for (; stretch < ends.size() && k + 1 == ends[stretch]; ++stretch)
                for (std::size_t i = 0; i < wanted; ++i) {
                    const InnovationSums now = likelihood.sums(i);
                    sums[i].push_back(difference(now, before[i]));
                    before[i] = now;
                }
        });
        return sums;
    });
}

template <int Axes>
InnovationSums innovation_sums(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                               const EstimationModel& model) {
    return innovation_sums_of<Axes>(arcs, {&model, 1}).front();
}

#define RUNCERT_INSTANTIATE(AXES)                                                            \
    template InnovationSums innovation_sums<AXES>(                                           \
        std::span<const std::span<const ArcEpoch<AXES>>>, const EstimationModel&);           \
    template std::vector<InnovationSums> innovation_sums_of<AXES>(                           \
        std::span<const std::span<const ArcEpoch<AXES>>>, std::span<const EstimationModel>); \
    template std::vector<std::vector<InnovationSums>> innovation_sums_along<AXES>(           \
        std::span<const ArcEpoch<AXES>>, std::span<const EstimationModel>,                   \
        std::span<const std::size_t>);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
