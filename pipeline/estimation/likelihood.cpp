#include "estimation/likelihood.h"

#include <Eigen/LU>
#include <cmath>

namespace runcert {

double InnovationSums::log_likelihood() const {
    return -0.5 * (statistic + log_determinant);
}

double InnovationSums::log_likelihood_at_best_scale() const {
    const auto n = static_cast<double>(values);
    return -0.5 * (n * std::log(statistic / n) + log_determinant + n);
}

template <int Axes>
InnovationSums innovation_sums(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                               const EstimationModel& model) {
    KalmanFilter<Axes> filter(model);
    InnovationSums sums;
    for (const std::span<const ArcEpoch<Axes>> arc : arcs) {
        filter_along<Axes>(filter, arc,
                           [&](std::size_t, const StateEstimate<Axes>&,
                               const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                               if (!seen || !seen->tests_model) return;
                               sums.statistic += seen->statistic;
                               sums.log_determinant += std::log(seen->covariance.determinant());
                               sums.values += Axes;
                           });
    }
    return sums;
}

template InnovationSums innovation_sums<1>(std::span<const std::span<const ArcEpoch<1>>>,
                                           const EstimationModel&);
template InnovationSums innovation_sums<2>(std::span<const std::span<const ArcEpoch<2>>>,
                                           const EstimationModel&);
template InnovationSums innovation_sums<3>(std::span<const std::span<const ArcEpoch<3>>>,
                                           const EstimationModel&);

}  // namespace runcert
