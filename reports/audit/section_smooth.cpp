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
std::vector<Block> noise_blocks(const NoiseSummary& noise, bool follows) {
    Facts facts{{{"Noise", noise_status_text(noise)},
                 {"Stated standard deviation",
                  fmt::format("{} m (root mean square){}", quantity_text(noise.stated_sigma_m),
                              noise.stated_all_equal ? ", the same at all epochs" : "")}}};
    if (noise.status != NoiseBasis::fitted) return {std::move(facts)};
    facts.add("Search",
              fmt::format("{} of the likelihood{}", counted(noise.evaluations, "evaluation"),
                          noise.converged ? "" : "; it did NOT converge"));
    facts.add("Scale of it", noise_parameter_text(noise.measurement_scale, noise));
    facts.add("Jerk density", noise_parameter_text(noise.jerk_density, noise, "m s^-2.5") +
                                  (follows ? "; the trajectory takes the larger of this and what "
                                             "the motion shows there (column jerk_density)"
                                           : ""));
    facts.add("Acceleration",
              noise.acceleration_time_s
                  ? fmt::format("correlation time {}; that is more likely than that it persists "
                                "(log-likelihood {} higher)",
                                noise_parameter_text(*noise.acceleration_time_s, noise, "s"),
                                format_fixed(noise.singer_gain, 2))
                  : fmt::format("persists: that it decays is no better (log-likelihood {} higher)",
                                format_fixed(noise.singer_gain, 2)));
    facts.add("Time-correlated error", correlated_error_text(noise));
    facts.add("Models weighed",
              counted(std::ssize(noise.posterior)) + ", by their profile likelihood");
    return {std::move(facts)};
}

std::vector<Block> health_blocks(const FilterHealth& health) {
    const std::string bounds = fmt::format(
        "mean square {} of {} innovations, expected within {} to {}; {} of {} spans outside their "
        "limits, {} allowed by chance: {}",
        format_fixed(health.mean_statistic, 4), counted(health.innovations),
        format_fixed(health.lower, 4), format_fixed(health.upper, 4), counted(health.spans_outside),
        counted(health.spans), counted(health.spans_allowed),
        health.consistent ? "consistent" : "NOT CONSISTENT");
    return {Facts{
        {{"Innovations", bounds},
         {"Correlation",
          fmt::format("{} from one innovation to the next ({} with the noise as stated): {}",
                      format_fixed(health.autocorrelation, 3),
                      format_fixed(health.autocorrelation_stated, 3),
                      health.white ? "white" : "NOT WHITE")},
         {"Numbers",
          fmt::format("largest condition {:.3g}, largest asymmetry {:.2g}, {} covariances repaired",
                      health.largest_condition, health.largest_asymmetry,
                      counted(health.repaired))}}}};
}

Facts agreement_facts(const EstimationSummary& estimation) {
    return {{{"Arcs", fmt::format("{}, with {} degrees of freedom", counted(estimation.arcs),
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
                                          counted(estimation.robust_unsolved, "arc"))}}};
}

Section axes_part(const char* title, const AxesEstimation& axes, bool follows) {
    Section part{.title = title, .blocks = noise_blocks(axes.noise, follows)};
    part.add(health_blocks(axes.health));
    return part;
}

}  // namespace

Section smooth_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("smooth", one.receiver.id);
    if (!one.trajectory) return missing_section(title, one.trajectory_file);
    const TrajectoryTable& table = *one.trajectory;
    const auto smoothed = std::ranges::count_if(
        table.rows, [](const TrajectoryEpoch& row) { return row.speed_m_s.has_value(); });
    const bool follows = std::ranges::any_of(table.rows, [](const TrajectoryEpoch& row) {
        return row.jerk_density || row.jerk_density_up;
    });
    Section section =
        product_section(record, title, table.header, one.trajectory_file,
                        fmt::format("{}, {} with a smoothed speed",
                                    counted(std::ssize(table.rows), "epoch"), counted(smoothed)),
                        all);
    section.add(agreement_facts(table.estimation));
    section.add(parameter_blocks(record.attempt, table.header, all));
    section.parts.push_back(axes_part("Horizontally", table.estimation.horizontal, follows));
    if (const auto& axes = table.estimation.vertical)
        section.parts.push_back(axes_part("Vertically", *axes, follows));
    return section;
}

}  // namespace runcert
