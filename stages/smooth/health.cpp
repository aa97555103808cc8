#include "stages/smooth/health.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr double level = 0.05;            // of the two-sided tests
constexpr double white_within = 0.1;      // of the autocorrelation at lag 1
constexpr std::size_t span_values = 100;  // scalar innovations in a span

/// Sums over the normalised innovations of some arcs.
struct InnovationStatistics {
    std::int64_t values = 0;
    double squares = 0.0;
    double lagged = 0.0;  ///< sum of products of neighbours, axis by axis
    std::int64_t spans = 0;
    std::int64_t spans_outside = 0;

    double autocorrelation() const { return squares > 0.0 ? lagged / squares : 0.0; }
};

/// Divides innovations into spans, and counts those whose sum of squares is outside its limits.
class SpanTest {
  public:
    explicit SpanTest(std::size_t length)
        : length_(length),
          lower_(chi_squared_quantile(level / 2, static_cast<int>(length))),
          upper_(chi_squared_quantile(1.0 - level / 2, static_cast<int>(length))) {}

    void add(double square, InnovationStatistics& statistics) {
        sum_ += square;
        if (++count_ < length_) return;
        ++statistics.spans;
        if (sum_ < lower_ || sum_ > upper_) ++statistics.spans_outside;
        sum_ = 0.0;
        count_ = 0;
    }

  private:
    std::size_t length_;
    double lower_;
    double upper_;
    double sum_ = 0.0;
    std::size_t count_ = 0;
};

template <int Axes>
InnovationStatistics innovation_statistics(const std::vector<Arc<Axes>>& arcs,
                                           const EstimationModel& model) {
    InnovationStatistics statistics;
    SpanTest spans(span_values);
    KalmanFilter<Axes> filter(model);
    for (const Arc<Axes>& arc : arcs) {
        PositionVector<Axes> before = PositionVector<Axes>::Zero();
        filter_along<Axes>(filter, std::span<const ArcEpoch<Axes>>(arc.epochs),
                           [&](std::size_t, const StateEstimate<Axes>&,
                               const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                               if (!seen || !seen->tests_model) {
                                   before.setZero();
                                   return;
                               }
                               const PositionVector<Axes> normalised = seen->normalised();
                               statistics.values += Axes;
                               statistics.squares += normalised.squaredNorm();
                               statistics.lagged += normalised.dot(before);
                               for (int axis = 0; axis < Axes; ++axis)
                                   spans.add(normalised(axis) * normalised(axis), statistics);
                               before = normalised;
                           });
    }
    return statistics;
}

/// Largest number of outlying spans that chance allows at the level of the test: a binomial count,
/// by its normal approximation with continuity correction.
std::int64_t spans_allowed(std::int64_t spans) {
    const auto n = static_cast<double>(spans);
    return static_cast<std::int64_t>(std::floor(
        n * level + 0.5 + normal_quantile(1.0 - level) * std::sqrt(n * level * (1.0 - level))));
}

}  // namespace

template <int Axes>
double innovation_autocorrelation(const std::vector<Arc<Axes>>& arcs,
                                  const EstimationModel& model) {
    return innovation_statistics(arcs, model).autocorrelation();
}

template <int Axes>
FilterHealth filter_health(const std::vector<Arc<Axes>>& arcs, const EstimationModel& model) {
    const InnovationStatistics used = innovation_statistics(arcs, model);
    FilterHealth health;
    health.innovations = used.values;
    health.autocorrelation = used.autocorrelation();
    health.white = std::abs(health.autocorrelation) <= white_within;
    if (used.values > 0) {
        const auto n = static_cast<double>(used.values);
        health.mean_statistic = used.squares / n;
        health.lower = chi_squared_quantile(level / 2, static_cast<int>(used.values)) / n;
        health.upper = chi_squared_quantile(1.0 - level / 2, static_cast<int>(used.values)) / n;
    }
    health.spans = used.spans;
    health.spans_outside = used.spans_outside;
    health.spans_allowed = spans_allowed(used.spans);
    health.consistent = health.mean_statistic >= health.lower &&
                        health.mean_statistic <= health.upper &&
                        health.spans_outside <= health.spans_allowed;
    return health;
}

template <int Axes>
void add_numerics(const std::vector<SmoothedMeans<Axes>>& smoothed, FilterHealth& health) {
    for (const SmoothedMeans<Axes>& arc : smoothed) {
        health.largest_asymmetry = std::max(health.largest_asymmetry, arc.largest_asymmetry);
        health.largest_condition = std::max(health.largest_condition, arc.largest_condition);
    }
}

#define RUNCERT_INSTANTIATE(AXES)                                                   \
    template double innovation_autocorrelation<AXES>(const std::vector<Arc<AXES>>&, \
                                                     const EstimationModel&);       \
    template FilterHealth filter_health<AXES>(const std::vector<Arc<AXES>>&,        \
                                              const EstimationModel&);              \
    template void add_numerics<AXES>(const std::vector<SmoothedMeans<AXES>>&, FilterHealth&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
