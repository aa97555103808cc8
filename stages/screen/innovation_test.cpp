#include "stages/screen/innovation_test.h"

#include <algorithm>
#include <map>

#include "core/statistics.h"
#include "motion/kalman.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

EstimationModel class_model(const ScreenConfig& config) {
    EstimationModel model;
    model.motion.jerk_density = config.jerk_density;
    return model;
}

template <int Axes>
PositionMeasurement<Axes> measurement_of(const ScreenedEpoch& row, double variance_factor) {
    return {.position = measured_position<Axes>(row),
            .covariance = variance_factor * stated_covariance<Axes>(row)};
}

/// Forward filter over one arc that can return to the state before a rejected epoch.
template <int Axes>
class ArcFilter {
  public:
    ArcFilter(const EstimationModel& model, double variance_factor)
        : filter_(model), variance_factor_(variance_factor) {}

    void restart() { started_ = false; }

    /// The innovation statistic of an epoch. Empty for the first of an arc, which a vague prior
    /// cannot test.
    std::optional<double> statistic(const ScreenedEpoch& row) {
        const auto measurement = measurement_of<Axes>(row, variance_factor_);
        predicted_ = started_ ? filter_.predict(estimate_, row.time.seconds() - time_s_)
                              : filter_.prior(measurement.position);
        if (!started_) measurements_ = 0;
        if (measurements_ < measurements_of_the_prior) return std::nullopt;
        estimate_ = predicted_;
        return filter_.update(estimate_, measurement).statistic();
    }

    /// Takes in the epoch tested last.
    void accept(const ScreenedEpoch& row) {
        estimate_ = predicted_;
        filter_.update(estimate_, measurement_of<Axes>(row, variance_factor_));
        time_s_ = row.time.seconds();
        started_ = true;
        ++measurements_;
    }

  private:
    KalmanFilter<Axes> filter_;
    double variance_factor_;
    bool started_ = false;
    int measurements_ = 0;
    double time_s_ = 0.0;
    StateEstimate<Axes> estimate_;
    StateEstimate<Axes> predicted_;
};

template <int Axes>
double variance_factor_of(const std::vector<ScreenedEpoch>& rows, const ScreenConfig& config) {
    ArcFilter<Axes> filter(class_model(config), 1.0);
    std::vector<double> statistics;
    for (const ScreenedEpoch& row : rows) {
        if (!row.usable) continue;
        if (row.break_before) filter.restart();
        if (const auto statistic = filter.statistic(row)) statistics.push_back(*statistic);
        filter.accept(row);
    }
    if (statistics.empty()) return 1.0;
    return std::max(1.0, median(statistics) / chi_squared_quantile(0.5, Axes));
}

void reject(ScreenedEpoch& row) {
    row.usable = false;
    row.reason = Reason::innovation;
}

void readmit(ScreenedEpoch& row) {
    row.usable = true;
    row.reason = Reason::none;
}

template <int Axes>
void test_rows(std::vector<ScreenedEpoch>& rows, double variance_factor,
               const ScreenConfig& config) {
    const double threshold = chi_squared_upper_quantile(config.false_alarm_rate, Axes);
    ArcFilter<Axes> filter(class_model(config), variance_factor);
    std::vector<std::size_t> rejected;  // consecutive, with no accepted epoch in between
    std::vector<bool> given_up(rows.size(), false);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        ScreenedEpoch& row = rows[i];
        if (!row.arc) continue;
        if (row.break_before) {
            filter.restart();
            rejected.clear();
        }
        const auto statistic = filter.statistic(row);
        // An epoch that restarted an arc keeps the statistic that broke the previous one.
        if (!given_up[i]) {
            row.statistic = statistic;
            row.threshold = statistic ? std::optional(threshold) : std::nullopt;
        }
        if (!statistic || *statistic <= threshold) {
            filter.accept(row);
            rejected.clear();
            continue;
        }
        reject(row);
        rejected.push_back(i);
        if (static_cast<std::int64_t>(rejected.size()) < config.restart_after) continue;
        const std::size_t first = rejected.front();
        for (const std::size_t index : rejected)
            readmit(rows[index]);
        given_up[first] = true;
        rows[first].break_before = ArcBreak::innovation;
        i = first - 1;
    }
}

}  // namespace

double robust_variance_factor(const std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                              const ScreenConfig& config) {
    return vertical_measured ? variance_factor_of<3>(rows, config)
                             : variance_factor_of<2>(rows, config);
}

void test_innovations(std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                      double variance_factor, const ScreenConfig& config) {
    if (vertical_measured)
        test_rows<3>(rows, variance_factor, config);
    else
        test_rows<2>(rows, variance_factor, config);
}

void drop_short_arcs(std::vector<ScreenedEpoch>& rows, const ScreenConfig& config) {
    std::int64_t arc = 0;
    std::map<std::int64_t, std::int64_t> epochs;
    for (ScreenedEpoch& row : rows) {
        if (!row.arc) continue;
        if (row.break_before) ++arc;
        row.arc = arc;
        epochs[arc] += row.usable ? 1 : 0;
    }
    std::map<std::int64_t, std::int64_t> number;
    for (const auto& [old_number, count] : epochs)
        if (count >= config.min_arc_epochs)
            number.emplace(old_number, static_cast<std::int64_t>(number.size()) + 1);
    for (ScreenedEpoch& row : rows) {
        if (!row.arc) continue;
        if (const auto kept = number.find(*row.arc); kept != number.end()) {
            row.arc = kept->second;
            continue;
        }
        if (row.usable) {
            row.reason = Reason::short_arc;
            row.statistic = static_cast<double>(epochs[*row.arc]);
            row.threshold = static_cast<double>(config.min_arc_epochs);
        }
        row.usable = false;
        row.arc.reset();
        row.break_before.reset();
    }
}

}  // namespace runcert
