#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

/// Sums of one forward filter over one or more arcs. The first measurements of each arc are left
/// out, because a vague prior predicts them. Positions are in m, so that innovation covariances are
/// in m^2.
struct InnovationSums {
    double statistic = 0.0;        ///< sum of the innovation statistics
    double log_determinant = 0.0;  ///< sum over the innovation covariances
    std::int64_t values = 0;       ///< scalar innovations: epochs times axes

    /// Log-likelihood of the innovations, without the constant -n/2 ln(2 pi).
    double log_likelihood() const;
    /// Log-likelihood with all variances of the model multiplied by the factor that maximises it,
    /// `statistic / values`.
    double log_likelihood_at_best_scale() const;
};

/// The sums over all arcs together. The likelihood treats the innovations as independent and normal
/// ([YSM22]). Requirements on an arc are given at `smooth` (smoother.h). Failure, naming the time,
/// where the covariance of a measurement is not positive definite.
template <int Axes>
InnovationSums innovation_sums(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                               const EstimationModel& model);

/// The sums of one arc under several models, separately for each stretch of it, as
/// sums[model][stretch]. `ends` holds, in order, one past the index of each stretch's last epoch.
/// The filter runs through all stretches without a restart.
template <int Axes>
std::vector<std::vector<InnovationSums>> innovation_sums_along(
    std::span<const ArcEpoch<Axes>> arc, std::span<const EstimationModel> models,
    std::span<const std::size_t> ends);

/// `innovation_sums` for several models, in their order and bit for bit. Two models share a pass,
/// and the passes run in parallel on as many threads as are allowed.
template <int Axes>
std::vector<InnovationSums> innovation_sums_of(
    std::span<const std::span<const ArcEpoch<Axes>>> arcs, std::span<const EstimationModel> models);

}  // namespace runcert
