#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// Sums of one forward filter over some arcs. The first measurements of each arc are left out, and
/// the first after a bridged step, because a vague prior predicts them. Positions are in m, so that
/// the innovation covariances are in m^2 for each axis.
struct InnovationSums {
    double statistic = 0.0;        ///< of the innovation statistics
    double log_determinant = 0.0;  ///< of the innovation covariances
    std::int64_t values = 0;       ///< scalar innovations: epochs times axes

    /// Logarithm of the likelihood of the innovations, without the constant -n/2 ln(2 pi).
    double log_likelihood() const;
    /// The same with all of the model's variances multiplied by the factor that makes it largest,
    /// `statistic / values`.
    double log_likelihood_at_best_scale() const;
};

/// The sums over all arcs together. The likelihood is that of the innovations, independent and
/// normal
/// ([YSM22]). What an arc must be is said at `smooth` (smoother.h). Failure, naming the time, where
/// the covariance of a measurement is not positive definite.
template <int Axes>
InnovationSums innovation_sums(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                               const EstimationModel& model);

/// Of one arc by several models, apart for each stretch of it: `ends` are the indices, in order,
/// one past the last epoch of each; sums[model][stretch]. The filter runs through all of them.
template <int Axes>
std::vector<std::vector<InnovationSums>> innovation_sums_along(
    std::span<const ArcEpoch<Axes>> arc, std::span<const EstimationModel> models,
    std::span<const std::size_t> ends);

/// The same for several models, in their order: two at a time in one pass, and the passes beside
/// one another on as many threads as are allowed. Bit for bit what `innovation_sums` gives for
/// each.
template <int Axes>
std::vector<InnovationSums> innovation_sums_of(
    std::span<const std::span<const ArcEpoch<Axes>>> arcs, std::span<const EstimationModel> models);

}  // namespace runcert
