#include "reports/certificate/json_noise.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_facts.h"
#include "reports/words/estimation.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

std::string error_text(const std::optional<NoiseParameter>& parameter, const NoiseSummary& noise,
                       std::string_view unit) {
    if (noise.correlated_error_detected && parameter)
        return noise_parameter_text(*parameter, noise, unit);
    return noise.status == NoiseBasis::fitted ? "not determined by the data" : "not looked for";
}

std::string acceleration_text(const NoiseSummary& noise) {
    if (!noise.acceleration_time_s) return "acceleration persists";
    return noise_parameter_text(*noise.acceleration_time_s, noise, "s");
}

std::string search_text(const NoiseSummary& noise) {
    if (noise.status != NoiseBasis::fitted) return "none";
    return fmt::format("{} after {} of the likelihood",
                       noise.converged ? "converged" : "stopped before it converged",
                       counted(noise.evaluations, "evaluation"));
}

std::string innovations_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{}: mean square {} of {}, limits {} to {}; {} of {} outside, {} allowed",
                       health.consistent ? "passed" : "not passed",
                       format_fixed(health.mean_statistic, 3),
                       counted(health.innovations, "innovation"), format_fixed(health.lower, 3),
                       format_fixed(health.upper, 3), health.spans_outside,
                       counted(health.spans, "span"), health.spans_allowed);
}

std::string autocorrelation_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{} with noise as stated, {} with the noise used: {}",
                       format_fixed(health.autocorrelation_stated, 3),
                       format_fixed(health.autocorrelation, 3),
                       health.white ? "white" : "not white");
}

std::string covariance_text(const FilterHealth& health) {
    return fmt::format("condition at most {}, asymmetry at most {}, {} repaired",
                       significant_text(health.largest_condition, 3),
                       scientific_text(health.largest_asymmetry), health.repaired);
}

/// A line of the table, of which each set of axes makes a cell.
struct NoiseLine {
    const char* label;
    std::string (*cell)(const AxesEstimation& axes);
};

constexpr std::array<NoiseLine, 11> noise_lines{{
    {"Noise", [](const AxesEstimation& axes) { return noise_status_text(axes.noise); }},
    {"Jerk density of the motion",
     [](const AxesEstimation& axes) {
         return noise_parameter_text(axes.noise.jerk_density, axes.noise, "m s^-2.5");
     }},
    {"Correlation time of the acceleration",
     [](const AxesEstimation& axes) { return acceleration_text(axes.noise); }},
    {"Scale of the stated standard deviations",
     [](const AxesEstimation& axes) {
         return fmt::format(
             "{}; stated {} m, {}",
             noise_parameter_text(axes.noise.measurement_scale, axes.noise, ""),
             significant_text(axes.noise.stated_sigma_m, 2),
             axes.noise.stated_all_equal ? "equal at all epochs" : "root mean square");
     }},
    {"Time-correlated position error, standard deviation",
     [](const AxesEstimation& axes) {
         return error_text(axes.noise.error_sigma_m, axes.noise, "m");
     }},
    {"its correlation time",
     [](const AxesEstimation& axes) {
         return error_text(axes.noise.error_tau_s, axes.noise, "s");
     }},
    {"its diffusion over short times",
     [](const AxesEstimation& axes) {
         return error_text(axes.noise.error_diffusion, axes.noise, "m s^-0.5");
     }},
    {"Search", [](const AxesEstimation& axes) { return search_text(axes.noise); }},
    {"Autocorrelation of the innovations, lag 1",
     [](const AxesEstimation& axes) { return autocorrelation_text(axes.health); }},
    {"Innovation test", [](const AxesEstimation& axes) { return innovations_text(axes.health); }},
    {"Covariances", [](const AxesEstimation& axes) { return covariance_text(axes.health); }},
}};

}  // namespace

Json noise_table(const EstimationSummary& estimation) {
    Json table{{"axes", Json::array({"Horizontal"})}, {"lines", Json::array()}};
    if (estimation.vertical) table["axes"].push_back("Vertical");
    for (const NoiseLine& line : noise_lines) {
        Json cells = Json::array();
        cells.push_back({{"axis", "Horizontal"}, {"text", line.cell(estimation.horizontal)}});
        if (estimation.vertical)
            cells.push_back({{"axis", "Vertical"}, {"text", line.cell(*estimation.vertical)}});
        table["lines"].push_back({{"label", line.label}, {"cells", std::move(cells)}});
    }
    return table;
}

}  // namespace runcert
