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

/// Forward filters of several models side by side, as far as their likelihood needs them.
/// KalmanFilter is the same filter for one model. Axes are `Joint` to a state. The states of all
/// have the same covariance: one for both axes is enough where each position has the same accuracy
/// east and north.
template <int Axes, int Joint>
class ForwardPass {
  public:
    ForwardPass(std::span<const EstimationModel> models, const PositionVector<Axes>& position)
        : models_(models) {
        for (std::size_t i = 0; i < models_side_by_side; ++i) {
            scale_[i] = models[i].measurement_scale * models[i].measurement_scale;
            for (int m = 0; m < Axes / Joint; ++m) {
                const StateEstimate<Joint> prior =
                    KalmanFilter<Joint>(models_[i])
                        .prior(position.template segment<Joint>(m * Joint));
                for (int row = 0; row < size; ++row) {
                    mean(m)[row][i] = prior.mean(row);
                    for (int column = 0; column <= row; ++column)
                        covariance_[row * size + column][i] = prior.covariance(row, column);
                }
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
        for (int m = 0; m < Axes / Joint; ++m)
            kernel::carry<Joint>(step_, mean(m).data());
        kernel::carry_covariance<Joint>(step_, covariance_.data());
    }

    /// Calls `count` with the innovation of each coordinate and its variance.
    template <class Count>
    void update(const ArcEpoch<Axes>& epoch, const Count& count) {
        const PositionMeasurement<Axes>& measurement = *epoch.measurement;
        const auto white = kernel::whitening_of<Joint>(
            measurement.covariance.template topLeftCorner<Joint, Joint>());
        if (!white.is_positive_definite())
            require_positive_definite<Axes>(measurement.covariance, epoch.time_s);
        for (int j = 0; j < Joint; ++j) {
            auto seen = kernel::compare<Joint, SideBySide>(white, j, scale_ * white.variance[j],
                                                           covariance_.data());
            for (int m = 0; m < Axes / Joint; ++m) {
                const double measured = kernel::whitened<Joint>(
                    white, j, [&](int axis) { return measurement.position(m * Joint + axis); });
                kernel::update_mean<Joint>(white, j, measured, seen, mean(m).data());
                count(seen.innovation, seen.variance);
            }
            kernel::reduce_covariance<Joint>(white, j, seen, covariance_.data());
        }
    }

  private:
    static constexpr int size = state_size<Joint>;
    using Mean = kernel::Numbers<SideBySide, size>;

    Mean& mean(int m) { return means_[static_cast<std::size_t>(m)]; }

    std::span<const EstimationModel> models_;
    SideBySide scale_{};
    StepKind kind_;
    std::array<AxisStep, models_side_by_side> of_length_;
    kernel::StepNumbers<SideBySide> step_;
    std::array<Mean, static_cast<std::size_t>(Axes / Joint)> means_{};
    kernel::Numbers<SideBySide, size * size> covariance_{};
};

/// Whether every position of an arc is as accurate along one axis as along the other, and
/// independently: but for the rounding of what turned it.
template <int Axes>
bool axes_are_alike(std::span<const ArcEpoch<Axes>> arc) {
    constexpr double rounding = 1e-5;
    return std::ranges::all_of(arc, [](const ArcEpoch<Axes>& epoch) {
        if (!epoch.measurement) return true;
        const PositionMatrix<Axes>& stated = epoch.measurement->covariance;
        const double variance = stated(0, 0);
        return (stated - variance * PositionMatrix<Axes>::Identity()).cwiseAbs().maxCoeff() <=
               rounding * variance;
    });
}

/// The likelihoods of several models side by side.
template <int Axes>
class Likelihood {
  public:
    explicit Likelihood(std::span<const EstimationModel> models) : models_(models) {}

    void add(std::span<const ArcEpoch<Axes>> arc) {
        add(arc, [](std::size_t) {});
    }

    /// Calls `visited(k)` after each epoch.
    template <class Visited>
    void add(std::span<const ArcEpoch<Axes>> arc, const Visited& visited) {
        if (axes_are_alike(arc))
            add_joint<1>(arc, visited);
        else
            add_joint<Axes>(arc, visited);
    }

    InnovationSums sums(std::size_t i) const {
        return {.statistic = statistic_[i],
                .log_determinant = determinants_[i].value(),
                .values = values_};
    }

  private:
    template <int Joint, class Visited>
    void add_joint(std::span<const ArcEpoch<Axes>> arc, const Visited& visited) {
        if (arc.empty()) return;
        ForwardPass<Axes, Joint> pass(models_, arc[0].measurement.value().position);
        UnknownsToTell unknowns;
        for (std::size_t k = 0; k < arc.size(); ++k) {
            if (k > 0) pass.carry(step_kind(arc[k - 1], arc[k]));
            if (arc[k].measurement) {
                const bool counts = !unknowns.determined_by_measurement();
                pass.update(arc[k], [&](const SideBySide& innovation, const SideBySide& variance) {
                    if (!counts) return;
                    statistic_ += innovation * innovation / variance;
                    for (std::size_t i = 0; i < models_side_by_side; ++i)
                        determinants_[i].multiply(variance[i]);
                    ++values_;
                });
            }
            visited(k);
        }
    }

    std::span<const EstimationModel> models_;
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
