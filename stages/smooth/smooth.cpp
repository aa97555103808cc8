#include "stages/smooth/smooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/parallel.h"
#include "stages/smooth/batch.h"
#include "stages/smooth/health.h"
#include "stages/smooth/noise.h"
#include "stages/smooth/robust.h"
#include "stages/smooth/trajectory_rows.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

/// Batch and smoother must agree to this fraction of the smoothed standard deviation, or to the
/// absolute limits, below which rounding of coordinates may dominate.
constexpr double agreement_of_sigma = 1e-4;
constexpr double agreement_position_m = 1e-6;
constexpr double agreement_velocity_m_s = 1e-5;

/// The least division of the batch, and the fraction of the required agreement that the divided
/// batch must reach.
constexpr BatchOptions shortest_stretch{.epochs_at_once = 12'000, .overlap = 2'000};
constexpr double near_the_smoother = 0.1;
constexpr double memories_from_a_cut = 20.0;

struct AgreementLimits {
    double position_m = agreement_position_m;
    double velocity_m_s = agreement_velocity_m_s;
};

/// Required agreement at a smoothed row, along its best known axis.
template <int Axes>
AgreementLimits limits_at(const TrajectoryEpoch& row) {
    const auto limit = [](double floor, double sigma) {
        return std::max(floor, agreement_of_sigma * sigma);
    };
    if constexpr (Axes == 1)
        return {limit(agreement_position_m, *row.sigma_up_m),
                limit(agreement_velocity_m_s, *row.sigma_velocity_up_m_s)};
    else
        return {limit(agreement_position_m, std::min(*row.sigma_east_m, *row.sigma_north_m)),
                limit(agreement_velocity_m_s,
                      std::min(*row.sigma_velocity_east_m_s, *row.sigma_velocity_north_m_s))};
}

/// The agreement of batch and smoother.
struct Agreement {
    std::int64_t stretches = 0;  ///< number of stretches of the batch
    double largest_position_difference_m = 0.0;
    double largest_velocity_difference_m_s = 0.0;

    bool within(const AgreementLimits& limits, double part = 1.0) const {
        return largest_position_difference_m <= part * limits.position_m &&
               largest_velocity_difference_m_s <= part * limits.velocity_m_s;
    }

    void add(const Agreement& other) {
        stretches += other.stretches;
        largest_position_difference_m =
            std::max(largest_position_difference_m, other.largest_position_difference_m);
        largest_velocity_difference_m_s =
            std::max(largest_velocity_difference_m_s, other.largest_velocity_difference_m_s);
    }
};

template <int Axes>
Agreement agreement_at(const SmoothedMeans<Axes>& smoothed, const BatchSolution<Axes>& batch,
                       std::size_t k) {
    const StateVector<Axes> difference = batch.states[k] - smoothed.states[k];
    return {.largest_position_difference_m = difference.template head<Axes>().norm(),
            .largest_velocity_difference_m_s = difference.template segment<Axes>(Axes).norm()};
}

/// Compares the batch solution with the smoothed one.
template <int Axes>
Agreement compare_batch(const Arc<Axes>& arc, const SmoothedMeans<Axes>& smoothed,
                        const BatchSolution<Axes>& batch,
                        const std::vector<TrajectoryEpoch>& rows) {
    Agreement agreement{.stretches = batch.stretches};
    for (std::size_t k = 0; k < batch.states.size(); ++k) {
        const Agreement here = agreement_at(smoothed, batch, k);
        agreement.add(here);
        const AgreementLimits limits = limits_at<Axes>(rows[arc.rows[k]]);
        if (!here.within(limits))
            throw Failure(
                fmt::format("epoch {}, {:.3f} s", rows[arc.rows[k]].epoch, arc.epochs[k].time_s),
                fmt::format("smoother and batch least squares differ by {:.2e} m and {:.2e} m/s, "
                            "more than {:.1e} m and {:.1e} m/s",
                            here.largest_position_difference_m,
                            here.largest_velocity_difference_m_s, limits.position_m,
                            limits.velocity_m_s),
                "The estimate cannot be trusted here; check stated standard deviations and time "
                "steps, and "
                "report it with the run folder");
    }
    return agreement;
}

/// Stretches as short as the memory of an arc allows: the effect of a cut has decayed where states
/// are used. It decays with the motion's memory and with the error's correlation time. The motion's
/// memory is about the time in which the uncertain velocity moves the position by its own
/// uncertainty.
template <int Axes>
BatchOptions stretches_for(const Arc<Axes>& arc, const SmoothedMeans<Axes>& smoothed,
                           const EstimationModel& model) {
    const StateMatrix<Axes>& middle = smoothed.covariance_in_the_middle;
    const double memory_s =
        std::max(std::sqrt(middle(0, 0) / middle(Axes, Axes)), model.error.tau_s);
    const auto epochs = static_cast<double>(arc.epochs.size());
    const double interval_s = (arc.epochs.back().time_s - arc.epochs.front().time_s) / epochs;
    const auto overlap = static_cast<std::size_t>(
        std::min(2.0 * memories_from_a_cut * memory_s / interval_s, epochs));
    return {.epochs_at_once = std::max(shortest_stretch.epochs_at_once, 2 * overlap),
            .overlap = std::max(shortest_stretch.overlap, overlap)};
}

/// The batch in stretches, which need less memory. If that is not close to the smoother, it solves
/// the arc as a whole, so that no difference comes from cuts.
template <int Axes>
BatchSolution<Axes> solve_in_stretches(const Arc<Axes>& arc, const SmoothedMeans<Axes>& smoothed,
                                       const EstimationModel& model,
                                       const std::vector<TrajectoryEpoch>& rows) {
    BatchSolution<Axes> batch =
        solve_batch<Axes>(arc.epochs, model, stretches_for(arc, smoothed, model));
    bool near = true;
    for (std::size_t k = 0; k < batch.states.size() && near; ++k)
        near = agreement_at(smoothed, batch, k)
                   .within(limits_at<Axes>(rows[arc.rows[k]]), near_the_smoother);
    if (near || batch.stretches == 1) return batch;
    return solve_batch<Axes>(arc.epochs, model, {.epochs_at_once = arc.epochs.size()});
}

/// Solves with a robust loss over the epochs that the innovation test kept and rejected.
void set_robust(const Arc<2>& arc, const SmoothedMeans<2>& smoothed, const EstimationModel& model,
                const SmoothConfig& config, TrajectoryTable& table) {
    const RobustSolution<2> robust =
        solve_robust<2>(arc.epochs, model, config.robust_scale, smoothed.states,
                        smoothed_sections<2>(arc.epochs, model));
    if (!robust.converged) ++table.estimation.robust_unsolved;
    for (std::size_t k = 0; k < robust.states.size(); ++k) {
        TrajectoryEpoch& row = table.rows[arc.rows[k]];
        row.robust_east_m = robust.states[k](0);
        row.robust_north_m = robust.states[k](1);
        row.robust_weight = robust.weights[k];
        if (row.robust_weight && *row.robust_weight < 0.5) ++table.estimation.robust_downweighted;
    }
}

template <int Axes>
struct AxesResult {
    AxesEstimation estimation;
    std::vector<Arc<Axes>> arcs;
    std::vector<SmoothedMeans<Axes>> smoothed;
    Agreement agreement;
};

/// Solves every arc as a batch, and compares it with the smoothed one.
template <int Axes>
Agreement check_by_batch(const AxesResult<Axes>& result, const EstimationModel& model,
                         std::vector<TrajectoryEpoch>& rows) {
    Agreement agreement;
    for (std::size_t a = 0; a < result.arcs.size(); ++a) {
        const Arc<Axes>& arc = result.arcs[a];
        const BatchSolution<Axes> batch =
            solve_in_stretches<Axes>(arc, result.smoothed[a], model, rows);
        agreement.add(compare_batch(arc, result.smoothed[a], batch, rows));
        if constexpr (Axes == 2)
            for (std::size_t k = 0; k < batch.states.size(); ++k)
                rows[arc.rows[k]].speed_batch_m_s = batch.states[k].template segment<2>(2).norm();
    }
    return agreement;
}

/// Estimates the noise, smooths every arc with it and compares it with the batch. Meanwhile it
/// calls `also(result, model)` for other uses of the smoothed arcs, which may write other columns
/// of the table.
template <int Axes, class Also>
AxesResult<Axes> estimate(const ScreenedTable& screened, const SmoothConfig& config,
                          TrajectoryTable& table, const Also& also) {
    AxesResult<Axes> result;
    result.arcs = arcs_of<Axes>(screened);
    EstimationModel as_stated;
    as_stated.motion.jerk_density = config.fit.initial_jerk_density;
    const double autocorrelation_stated = innovation_autocorrelation<Axes>(result.arcs, as_stated);
    result.estimation.noise = estimate_noise<Axes>(result.arcs, config);
    const EstimationModel model = model_of(result.estimation.noise);
    result.estimation.health = filter_health<Axes>(result.arcs, model);
    result.estimation.health.autocorrelation_stated = autocorrelation_stated;
    set_jerk_densities<Axes>(result.arcs, result.estimation.noise, config);
    for (const Arc<Axes>& arc : result.arcs) {
        result.smoothed.push_back(smooth_rows<Axes>(arc, model, table.rows));
        set_jerk_density(arc, model, table.rows);
    }
    add_numerics<Axes>(result.smoothed, result.estimation.health);
    do_together([&] { result.agreement = check_by_batch<Axes>(result, model, table.rows); },
                [&] { also(result, model); });
    return result;
}

/// Fills the parts of the summary that concern only the horizontal estimate.
void summarise_horizontal(const AxesResult<2>& result, EstimationSummary& summary) {
    summary.arcs = static_cast<std::int64_t>(result.arcs.size());
    // The vague prior leaves position, velocity and acceleration of each axis to the data.
    for (const SmoothedMeans<2>& smoothed : result.smoothed)
        summary.degrees_of_freedom += 2 * smoothed.measurements - 6;
    if (summary.degrees_of_freedom > 0)
        summary.variance_factor = result.estimation.health.mean_statistic;
    const double scale = result.estimation.noise.measurement_scale.value;
    summary.variance_factor_applied = scale * scale;
    summary.horizontal = result.estimation;
}

Agreement estimate_horizontal(const ScreenedTable& screened, const SmoothConfig& config,
                              TrajectoryTable& table) {
    const AxesResult<2> result = estimate<2>(
        screened, config, table, [&](const AxesResult<2>& smoothed, const EstimationModel& model) {
            auto robust_arcs = arcs_of<2>(screened, Measurements::before_rejection);
            for (std::size_t a = 0; a < robust_arcs.size(); ++a) {
                Arc<2>& arc = robust_arcs[a];
                for (std::size_t k = 0; k < arc.epochs.size(); ++k)
                    arc.epochs[k].jerk_factor = smoothed.arcs[a].epochs[k].jerk_factor;
                set_robust(arc, smoothed.smoothed[a], model, config, table);
            }
        });
    for (const Arc<2>& arc : result.arcs)
        set_paper_methods(arc, config.dhd22_acceleration_sigma_m_s2, table.rows);
    summarise_horizontal(result, table.estimation);
    return result.agreement;
}

Agreement estimate_vertical(const ScreenedTable& screened, const SmoothConfig& config,
                            TrajectoryTable& table) {
    const AxesResult<1> result =
        estimate<1>(screened, config, table, [](const AxesResult<1>&, const EstimationModel&) {});
    table.estimation.vertical = result.estimation;
    return result.agreement;
}

}  // namespace

SmoothConfig smooth_config(const Attempt& attempt) {
    const SmoothParameters& parameters = attempt.parameters.smooth;
    SmoothConfig config;
    config.fit_noise = parameters.noise == NoiseChoice::fitted;
    config.fit = fit_options(parameters);
    config.robust_scale = parameters.robust_scale;
    config.dhd22_acceleration_sigma_m_s2 = parameters.dhd22_acceleration_sigma;
    return config;
}

TrajectoryTable smooth_trajectory(const ScreenedTable& screened, const SmoothConfig& config) {
    TrajectoryTable table;
    table.facts = screened.facts;
    table.origin = screened.origin;
    table.rows.reserve(screened.rows.size());
    for (const ScreenedEpoch& row : screened.rows) {
        TrajectoryEpoch& epoch = table.rows.emplace_back();
        epoch.epoch = row.epoch;
        epoch.time = row.time;
        epoch.arc = row.arc;
        epoch.usable = row.usable;
    }
    // In parallel: each task sets its own columns, and its own part of the summary.
    Agreement agreement;
    Agreement of_heights;
    do_together([&] { agreement = estimate_horizontal(screened, config, table); },
                [&] {
                    if (screened.facts.vertical_measured)
                        of_heights = estimate_vertical(screened, config, table);
                });
    agreement.add(of_heights);
    table.estimation.batch_stretches = agreement.stretches;
    table.estimation.largest_position_difference_m = agreement.largest_position_difference_m;
    table.estimation.largest_velocity_difference_m_s = agreement.largest_velocity_difference_m_s;
    return table;
}

}  // namespace runcert
