#include "estimation/likelihood.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "estimation/innovation_filter.h"

namespace runcert {

double InnovationSums::log_likelihood() const {
    return -0.5 * (statistic + log_determinant);
}

double InnovationSums::log_likelihood_at_best_scale() const {
    const auto n = static_cast<double>(values);
    return -0.5 * (n * std::log(statistic / n) + log_determinant + n);
}

namespace {

/// The logarithm of a product of many factors, taken once for as many as fit a double's range.
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
    // One more factor within these bounds stays within the range.
    static constexpr double smallest = 1e-150;
    static constexpr double largest = 1e150;
    double product_ = 1.0;
    double sum_ = 0.0;
};

/// The filters of as many models as stand side by side.
template <int Axes>
class Likelihood {
  public:
    static constexpr std::size_t models_at_once = models_side_by_side;

    explicit Likelihood(std::span<const EstimationModel> models) : models_(models) {
        for (std::size_t i = 0; i < models_at_once; ++i) {
            const double scale = models[i].measurement_scale;
            scale_[i] = scale * scale;
        }
    }

    void add(std::span<const ArcEpoch<Axes>> arc) {
        if (arc.empty()) return;
        Filter filter = begin(arc[0].measurement.value().position);
        UnknownsToTell unknowns;
        for (std::size_t k = 0; k < arc.size(); ++k) {
            if (k > 0) {
                filter.carry(step_over(arc[k].time_s - arc[k - 1].time_s));
                if (arc[k].step_before) {
                    filter.add_offset(vague_position_sigma_m * vague_position_sigma_m);
                    unknowns.add_step();
                }
            }
            if (!arc[k].measurement) continue;
            require_positive_definite<Axes>(arc[k].measurement->covariance, arc[k].time_s);
            const auto seen = filter.take_in(measured(*arc[k].measurement));
            if (unknowns.told_by_measurement()) continue;
            statistic_ += seen.statistic;
            for (std::size_t i = 0; i < models_at_once; ++i)
                determinants_[i].multiply(seen.determinant[i]);
            values_ += Axes;
        }
    }

    InnovationSums sums(std::size_t i) const {
        return {.statistic = statistic_[i],
                .log_determinant = determinants_[i].value(),
                .values = values_};
    }

  private:
    using Filter = InnovationFilter<Axes>;
    using Step = typename Filter::Step;

    Filter begin(const PositionVector<Axes>& position) const {
        typename Filter::template Array<Filter::size> mean{};
        typename Filter::template Array<Filter::size> variance{};
        for (std::size_t i = 0; i < models_at_once; ++i) {
            const StateEstimate<Axes> prior = KalmanFilter<Axes>(models_[i]).prior(position);
            for (int row = 0; row < Filter::size; ++row) {
                mean[static_cast<std::size_t>(row)][i] = prior.mean(row);
                variance[static_cast<std::size_t>(row)][i] = prior.covariance(row, row);
            }
        }
        return Filter(mean, variance);
    }

    typename Filter::Measured measured(const PositionMeasurement<Axes>& measurement) const {
        typename Filter::Measured result;
        std::size_t next = 0;
        for (int row = 0; row < Axes; ++row) {
            result.position[static_cast<std::size_t>(row)] = measurement.position(row);
            for (int column = 0; column <= row; ++column)
                result.covariance[next++] = scale_ * measurement.covariance(row, column);
        }
        return result;
    }

    /// Kept while the step, to the nanosecond, stays the same.
    const Step& step_over(double dt_s) {
        const std::int64_t step_ns = std::llround(dt_s * 1e9);
        if (step_ns == step_ns_) return step_;
        step_ns_ = step_ns;
        for (std::size_t i = 0; i < models_at_once; ++i) {
            const AxisStep one = axis_step(models_[i], static_cast<double>(step_ns) * 1e-9);
            step_.position_of_velocity[i] = one.transition(0, 1);
            step_.position_of_acceleration[i] = one.transition(0, 2);
            step_.velocity_of_acceleration[i] = one.transition(1, 2);
            step_.acceleration[i] = one.transition(2, 2);
            step_.error[i] = one.error_transition;
            step_.error_noise[i] = one.error_noise;
            std::size_t next = 0;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column <= row; ++column)
                    step_.noise[next++][i] = one.process_noise(row, column);
        }
        return step_;
    }

    std::span<const EstimationModel> models_;
    SideBySide scale_{};
    std::int64_t step_ns_ = -1;
    Step step_;
    SideBySide statistic_{};
    std::array<LogOfProduct, models_at_once> determinants_;
    std::int64_t values_ = 0;
};

}  // namespace

template <int Axes>
std::vector<InnovationSums> innovation_sums_of(
    std::span<const std::span<const ArcEpoch<Axes>>> arcs,
    std::span<const EstimationModel> models) {
    constexpr std::size_t together = models_side_by_side;
    const auto groups = static_cast<std::int64_t>((models.size() + together - 1) / together);
    const auto sums = results_of(groups, threads_allowed(), [&](std::int64_t group) {
        const std::size_t first = static_cast<std::size_t>(group) * together;
        const auto wanted = models.subspan(first, std::min(together, models.size() - first));
        std::vector<EstimationModel> models_together(wanted.begin(), wanted.end());
        models_together.resize(together, models_together.back());
        Likelihood<Axes> likelihood(models_together);
        for (const std::span<const ArcEpoch<Axes>> arc : arcs)
            likelihood.add(arc);
        std::vector<InnovationSums> of_group;
        for (std::size_t i = 0; i < wanted.size(); ++i)
            of_group.push_back(likelihood.sums(i));
        return of_group;
    });
    std::vector<InnovationSums> all;
    for (const std::vector<InnovationSums>& of_group : sums)
        all.insert(all.end(), of_group.begin(), of_group.end());
    return all;
}

template <int Axes>
InnovationSums innovation_sums(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                               const EstimationModel& model) {
    return innovation_sums_of<Axes>(arcs, {&model, 1}).front();
}

#define RUNCERT_INSTANTIATE(AXES)                                                  \
    template InnovationSums innovation_sums<AXES>(                                 \
        std::span<const std::span<const ArcEpoch<AXES>>>, const EstimationModel&); \
    template std::vector<InnovationSums> innovation_sums_of<AXES>(                 \
        std::span<const std::span<const ArcEpoch<AXES>>>, std::span<const EstimationModel>);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
RUNCERT_INSTANTIATE(3)

}  // namespace runcert
