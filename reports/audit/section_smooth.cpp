#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/sections.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

std::string correlated_error_text(const NoiseSummary& noise) {
    if (!noise.correlated_error_detected || !noise.error_sigma_m || !noise.error_tau_s)
        return fmt::format(
            "could not be separated from white noise and motion (looked for from {} s to {} s): "
            "the bound of the window stage decides",
            quantity_text(noise.tau_min_s), quantity_text(noise.tau_max_s));
    return fmt::format("{}; correlation time {}",
                       noise_parameter_text(*noise.error_sigma_m, noise, "m"),
                       noise_parameter_text(*noise.error_tau_s, noise, "s"));
}

/// `follows`: whether the trajectory says the jerk density epoch by epoch.
Block noise_facts(const NoiseSummary& noise, bool follows) {
    Block told =
        facts({{"Noise", noise_status_text(noise)},
               {"Stated standard deviation",
                fmt::format("{} m (root mean square){}", quantity_text(noise.stated_sigma_m),
                            noise.stated_all_equal ? ", the same at all epochs" : "")}});
    if (noise.status != NoiseBasis::fitted) return told;
    add_fact(told, "Search",
             fmt::format("{} of the likelihood{}", counted(noise.evaluations, "evaluation"),
                         noise.converged ? "" : "; it did NOT converge"));
    add_fact(told, "Scale of it", noise_parameter_text(noise.measurement_scale, noise));
    add_fact(told, "Jerk density",
             noise_parameter_text(noise.jerk_density, noise, "m s^-2.5") +
                 (follows ? "; the trajectory takes the larger of this and what "
                            "the motion shows there (column jerk_density)"
                          : ""));
    add_fact(told, "Acceleration",
             noise.acceleration_time_s
                 ? fmt::format("correlation time {}; that is more likely than that it persists "
                               "(log-likelihood {} higher)",
                               noise_parameter_text(*noise.acceleration_time_s, noise, "s"),
                               format_fixed(noise.singer_gain, 2))
                 : fmt::format("persists: that it decays is no better (log-likelihood {} higher)",
                               format_fixed(noise.singer_gain, 2)));
    add_fact(told, "Time-correlated error", correlated_error_text(noise));
    add_fact(told, "Models weighed",
             counted(std::ssize(noise.posterior)) + ", by their profile likelihood");
    return told;
}

Block health_facts(const FilterHealth& health) {
    const std::string bounds = fmt::format(
        "mean square {} of {} innovations, expected within {} to {}; {} of {} spans outside their "
        "limits, {} allowed by chance: {}",
        format_fixed(health.mean_statistic, 4), counted(health.innovations),
        format_fixed(health.lower, 4), format_fixed(health.upper, 4), counted(health.spans_outside),
        counted(health.spans), counted(health.spans_allowed),
        health.consistent ? "consistent" : "NOT CONSISTENT");
    return facts(
        {{"Innovations", bounds},
         {"Correlation",
          fmt::format("{} from one innovation to the next ({} with the noise as stated): {}",
                      format_fixed(health.autocorrelation, 3),
                      format_fixed(health.autocorrelation_stated, 3),
                      health.white ? "white" : "NOT WHITE")},
         {"Numbers",
          fmt::format("largest condition {:.3g}, largest asymmetry {:.2g}, {} covariances repaired",
                      health.largest_condition, health.largest_asymmetry,
                      counted(health.repaired))}});
}

Block agreement_facts(const EstimationSummary& estimation) {
    return facts(
        {{"Arcs", fmt::format("{}, with {} degrees of freedom", counted(estimation.arcs),
                              counted(estimation.degrees_of_freedom))},
         {"Batch and smoother",
          fmt::format("differ by at most {:.2g} m and {:.2g} m/s; the batch was solved in {}",
                      estimation.largest_position_difference_m,
                      estimation.largest_velocity_difference_m_s,
                      counted(estimation.batch_stretches) +
                          (estimation.batch_stretches == 1 ? " stretch" : " stretches"))},
         {"Variance factor",
          fmt::format("{} after the estimate; {} applied to the stated covariances",
                      format_fixed(estimation.variance_factor, 3),
                      format_fixed(estimation.variance_factor_applied, 3))},
         {"Robust batch", fmt::format("{} with less than half their weight; {} not solved",
                                      counted(estimation.robust_downweighted, "epoch"),
                                      counted(estimation.robust_unsolved, "arc"))}});
}

void add_axes(std::vector<Block>& blocks, const char* title, const AxesEstimation& axes,
              bool follows) {
    append(blocks, {heading(title), noise_facts(axes.noise, follows), health_facts(axes.health)});
}

}  // namespace

std::vector<Block> smooth_blocks(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const TrajectoryTable& table = *one.trajectory;
    const auto smoothed = std::ranges::count_if(
        table.rows, [](const TrajectoryEpoch& row) { return row.speed_m_s.has_value(); });
    const bool follows = std::ranges::any_of(table.rows, [](const TrajectoryEpoch& row) {
        return row.jerk_density || row.jerk_density_up;
    });
    std::vector<Block> blocks =
        product_blocks(record, table.header, one.trajectory_file,
                       fmt::format("{}, {} with a smoothed speed",
                                   counted(std::ssize(table.rows), "epoch"), counted(smoothed)),
                       all);
    blocks.push_back(agreement_facts(table.estimation));
    append(blocks, parameter_blocks(record.attempt, table.header, all));
    add_axes(blocks, "Horizontally", table.estimation.horizontal, follows);
    if (const auto& axes = table.estimation.vertical)
        add_axes(blocks, "Vertically", *axes, follows);
    return blocks;
}

}  // namespace runcert
