#include "stages/screen/speed_tests.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "stages/screen/adaptation.h"
#include "witness/copies.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

constexpr std::size_t fewest = 30;
constexpr double most_worse = 9.0;  ///< variance over the usual one
/// How long a change of acceleration takes. The speed's third state is its jerk: an acceleration
/// that persists, driven by jerks that do not.
constexpr double jerk_time_s = 0.3;

/// Recorded speeds without a gap, in order of time.
struct SpeedArc {
    std::vector<std::size_t> rows;
    std::vector<ArcEpoch<1>> epochs;
};

std::vector<SpeedArc> speed_arcs(const std::vector<ScreenedEpoch>& rows, bool upright,
                                 double longest_step_s) {
    std::vector<SpeedArc> arcs;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto speed = recorded_speed(rows[i], !upright, upright);
        if (!speed || is_out_of_time(rows[i])) continue;
        const double time_s = rows[i].time.seconds();
        if (arcs.empty() || time_s - arcs.back().epochs.back().time_s > longest_step_s)
            arcs.emplace_back();
        const double sigma = speed->standard_uncertainty_m_s.value_or(0.0);
        arcs.back().rows.push_back(i);
        arcs.back().epochs.push_back(
            {.time_s = time_s,
             .measurement = PositionMeasurement<1>{
                 .position = PositionVector<1>(upright ? *rows[i].recorded_velocity_up_m_s
                                                       : speed->speed_m_s),
                 .covariance = PositionMatrix<1>(sigma * sigma)}});
    }
    std::erase_if(arcs, [](const SpeedArc& arc) { return arc.rows.size() < 4; });
    return arcs;
}

double speed_of(const ArcEpoch<1>& epoch) {
    return epoch.measurement->position(0);
}

/// The white noise of one speed (m/s), not less than rounding to its resolution makes.
double white_noise_of(const std::vector<SpeedArc>& arcs) {
    std::vector<double> third;
    std::vector<TimedValue> speeds;
    for (const SpeedArc& arc : arcs)
        for (std::size_t k = 0; k < arc.epochs.size(); ++k) {
            speeds.push_back({arc.epochs[k].time_s, speed_of(arc.epochs[k])});
            if (k >= 3)
                third.push_back(
                    std::abs(speed_of(arc.epochs[k]) - speed_of(arc.epochs[k - 3]) -
                             3.0 * (speed_of(arc.epochs[k - 1]) - speed_of(arc.epochs[k - 2]))));
        }
    return std::max(robust_sd(std::move(third), 20.0), resolution_m_s(speeds) / std::sqrt(12.0));
}

/// Gives each sample the white noise as its standard deviation, up to three times as much where it
/// states more than the median. A sample that states still more is not believed for that: it would
/// excuse itself.
void set_covariances(std::vector<SpeedArc>& arcs, double white_m_s) {
    std::vector<double> stated;
    for (const SpeedArc& arc : arcs)
        for (const ArcEpoch<1>& epoch : arc.epochs)
            stated.push_back(epoch.measurement->covariance(0));
    const double usual = median(std::move(stated));
    for (SpeedArc& arc : arcs)
        for (ArcEpoch<1>& epoch : arc.epochs) {
            double& variance = epoch.measurement->covariance(0);
            variance = white_m_s * white_m_s *
                       (usual > 0.0 ? std::clamp(variance / usual, 1.0, most_worse) : 1.0);
        }
}

void refuse(ScreenedEpoch& row, const ScreeningDecision& decision, TestedAxes axes) {
    if (row.speed_test.refused) return;
    row.speed_test = {.refused = decision.hypothesis,
                      .axes = axes,
                      .statistic = decision.statistic,
                      .threshold = decision.threshold,
                      .error_m_s = {}};
}

/// Refuses what the decisions on an arc leave out, and what lies beside and between its steps. A
/// drift is motion unless the craft cannot accelerate so.
void refuse_decided(const SpeedArc& arc, const ArcDecisions& decisions, TestedAxes axes,
                    double acceleration_max_m_s2, std::vector<ScreenedEpoch>& rows) {
    constexpr double longest_s = 30.0;
    constexpr double coverage = 3.0;
    double offset_m_s = 0.0, variance = 0.0;
    std::size_t begin = 0;
    for (std::size_t k = 0; k < arc.rows.size(); ++k) {
        if (const auto& decision = decisions.left_out[k])
            refuse(rows[arc.rows[k]], *decision, axes);
        const auto& decision = decisions.breaks[k];
        if (!decision || k == 0) continue;
        const bool step = decision->hypothesis == Hypothesis::step;
        if (!step &&
            std::abs(decision->estimated.rate_up_m_s.value_or(0.0)) <= acceleration_max_m_s2)
            continue;
        for (const std::size_t i : {k - 1, k})
            refuse(rows[arc.rows[i]], *decision, axes);
        if (!step) continue;
        if (variance > 0.0 && arc.epochs[k].time_s - arc.epochs[begin].time_s > longest_s)
            offset_m_s = variance = 0.0;
        if (variance == 0.0) begin = k;
        offset_m_s += decision->estimated.up_m.value_or(0.0);
        variance += std::pow(decision->estimated.sigma_up_m.value_or(0.0), 2);
        if (std::abs(offset_m_s) > coverage * std::sqrt(variance)) continue;
        for (std::size_t i = begin; i < k; ++i)
            refuse(rows[arc.rows[i]], *decision, axes);
        offset_m_s = variance = 0.0;
    }
}

/// What the tests of an arc find with the plan's power, by the length of a burst; the error of each
/// sample that is refused.
void examine(const SpeedArc& arc, const ArcDecisions& decisions, const EstimationModel& model,
             const TestPlan& plan, std::vector<std::vector<double>>& detectable,
             std::vector<ScreenedEpoch>& rows) {
    for (const TestedStretch<1>& stretch : stretches_of<1>(arc.epochs, model, decisions)) {
        const StretchTests<1> tests(stretch, model, plan);
        const Chain<1>& diagnosis = tests.diagnosis();
        const auto add = [&](std::size_t k, std::size_t length, const ScoreTest<1>& test) {
            detectable[length - 1].push_back(
                std::sqrt(tests.factor(k) * plan.noncentrality(1) / test.precision(0)));
        };
        for (std::size_t k = 0; k < diagnosis.size(); ++k) {
            const std::size_t at = stretch.first + k;
            auto& found = rows[arc.rows[at]].speed_test;
            if (stretch.epochs[k].measurement) add(k, 1, diagnosis.outlier(k));
            if (found.refused && !found.error_m_s)
                found.error_m_s = (stretch.epochs[k].measurement
                                       ? diagnosis.outlier(k)
                                       : diagnosis.left_out(k, *arc.epochs[at].measurement))
                                      .estimate()(0);
        }
        diagnosis.for_each_burst(detectable.size(), add);
    }
}

SpeedScreening screen_axes(std::vector<ScreenedEpoch>& rows, std::vector<SpeedArc> arcs,
                           TestedAxes axes, const TestPlan& plan, double jerk_density,
                           const ScreenConfig& config) {
    SpeedScreening found{.axes = axes, .white_m_s = white_noise_of(arcs)};
    set_covariances(arcs, found.white_m_s);
    EstimationModel model;
    model.motion = {.jerk_density = jerk_density / jerk_time_s, .acceleration_time_s = jerk_time_s};
    std::vector<std::vector<double>> detectable(plan.burst_epochs_max());
    for (const SpeedArc& arc : arcs) {
        const ArcDecisions decisions = adapt<1>(arc.epochs, model, plan, config.section_epochs);
        refuse_decided(arc, decisions, axes, config.limits.acceleration_m_s2, rows);
        examine(arc, decisions, model, plan, detectable, rows);
        found.tested += std::ssize(arc.rows);
        found.refused += std::ranges::count_if(arc.rows, [&](std::size_t row) {
            return rows[row].speed_test.refused && rows[row].speed_test.axes == axes;
        });
    }
    for (std::vector<double>& sizes : detectable)
        if (!sizes.empty())
            found.detectable.push_back(
                {.samples = &sizes - detectable.data() + 1, .size_m_s = median(std::move(sizes))});
    return found;
}

}  // namespace

std::vector<SpeedScreening> screen_speeds(std::vector<ScreenedEpoch>& rows, const TestPlan& plan,
                                          double jerk_density, const ScreenConfig& config,
                                          double nominal_interval_s) {
    std::vector<SpeedScreening> all;
    if (!recorded_velocities_change(rows)) return all;
    const TestPlan of_speeds = plan.with_manoeuvres(config.limits.acceleration_m_s2 / jerk_time_s);
    for (const TestedAxes axes : {TestedAxes::horizontal, TestedAxes::vertical}) {
        std::vector<SpeedArc> arcs =
            speed_arcs(rows, axes == TestedAxes::vertical, config.bridged_s(nominal_interval_s));
        std::size_t samples = 0;
        for (const SpeedArc& arc : arcs)
            samples += arc.rows.size();
        if (samples >= fewest)
            all.push_back(
                screen_axes(rows, std::move(arcs), axes, of_speeds, jerk_density, config));
    }
    return all;
}

}  // namespace runcert
