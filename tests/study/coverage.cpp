#include "coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "stages/smooth/noise.h"
#include "stages/window/position_speed.h"

namespace runcert {
namespace {

constexpr double window_start_s = 40.0;
constexpr double window_length_s = 3.0;

void count(Coverage& coverage, double error_m_s, double standard_uncertainty_m_s) {
    static const double factor = normal_quantile(0.975);
    const double half_width = factor * standard_uncertainty_m_s;
    ++coverage.runs;
    if (std::abs(error_m_s) <= half_width) ++coverage.held;
    coverage.squares += std::pow(error_m_s / standard_uncertainty_m_s, 2);
    coverage.half_width_m_s +=
        (half_width - coverage.half_width_m_s) / static_cast<double>(coverage.runs);
    coverage.largest_half_width_m_s = std::max(coverage.largest_half_width_m_s, half_width);
}

void count_model(Coverage& coverage, const WindowStretch<2>& stretch, const EstimationModel& model,
                 double true_m_s) {
    const SpeedEstimate speed = smoothed_speed(Chain<2>(stretch.epochs, model), stretch.window,
                                               stretch.duration_s, {SpeedDefinition::displacement});
    count(coverage, speed.speed_m_s - true_m_s, speed.standard_uncertainty_m_s);
}

/// One recording of a cell.
void study_one(CoverageCell& cell, const CoverageOptions& options, std::uint64_t seed,
               bool estimate) {
    const SimulatedRecording recording = simulate_recording(cell.run, seed);
    const auto first = static_cast<std::size_t>(std::lround(window_start_s * cell.run.rate_hz));
    const auto last =
        first + static_cast<std::size_t>(std::lround(window_length_s * cell.run.rate_hz));
    const double true_m_s =
        (recording.truth[last] - recording.truth[first]).norm() / window_length_s;
    std::vector<Arc<2>> arcs = arcs_of<2>(recording.screened);
    WindowStretch<2> stretch = cut_stretch(arcs.front(), {first, last}, 60.0);

    EstimationModel model;
    model.motion.jerk_density = cell.run.jerk_density;
    count_model(cell.white, stretch, model, true_m_s);
    model.error =
        GaussMarkovError::steady(cell.run.noise.error_sigma_m, cell.run.noise.error_tau_s);
    count_model(cell.known, stretch, model, true_m_s);
    if (!estimate) return;

    const NoiseSummary noise = estimate_noise<2>(arcs, SmoothConfig{});
    set_jerk_densities<2>(arcs, noise, SmoothConfig{});
    stretch = cut_stretch(arcs.front(), {first, last}, 60.0);
    const FittedSpeed fitted =
        fitted_speed(stretch, posterior_of(noise), {SpeedDefinition::displacement});
    count(cell.fitted, fitted.speed_m_s - true_m_s, fitted.standard_uncertainty_m_s);
    UncertaintyRule rule;
    rule.error_floor_m = {{"fixed", options.floor_m}};
    const ErrorBound bound = error_bound<2>(recording.screened, first, last, noise, rule);
    const EstimationModel fitted_model = model_of(noise);
    const Chain<2> smoothed = Chain<2>(stretch.epochs, fitted_model);
    const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                .smoothed = smoothed,
                                .model = fitted_model,
                                .window = stretch.window,
                                .duration_s = stretch.duration_s};
    const SpeedQuantity quantity{SpeedDefinition::displacement};
    const SpeedEstimate speed =
        speed_by_positions(at, quantity, speed_weights(at, quantity), bound).speed;
    count(cell.bound, speed.speed_m_s - true_m_s, speed.standard_uncertainty_m_s);
}

}  // namespace

Coverage& Coverage::operator+=(const Coverage& other) {
    const auto share = static_cast<double>(other.runs) / static_cast<double>(runs + other.runs);
    half_width_m_s += share * (other.half_width_m_s - half_width_m_s);
    largest_half_width_m_s = std::max(largest_half_width_m_s, other.largest_half_width_m_s);
    runs += other.runs;
    held += other.held;
    squares += other.squares;
    return *this;
}

std::vector<CoverageCell> coverage_cells(double rate_hz, double jerk_density) {
    std::vector<CoverageCell> cells;
    const auto add = [&](const StudyNoise& noise) {
        CoverageCell cell;
        cell.run.rate_hz = rate_hz;
        cell.run.jerk_density = jerk_density;
        cell.run.noise = noise;
        cells.push_back(cell);
    };
    for (const double white_m : {0.003, 0.010, 0.030})
        add({.white_m = white_m});
    for (const double tau_s : {0.5, 2.0, 10.0, 60.0})
        add({.white_m = 0.003, .error_sigma_m = 0.008, .error_tau_s = tau_s});
    return cells;
}

CoverageCell study_coverage(CoverageCell cell, const CoverageOptions& options) {
    for (std::int64_t i = 0; i < options.runs_known; ++i)
        study_one(cell, options, options.seed * 1'000'003 + static_cast<std::uint64_t>(i),
                  i < options.runs);
    return cell;
}

std::string coverage_table(const std::vector<CoverageCell>& cells) {
    std::string text =
        "Coverage of 95 % intervals of the 3 s speed; half widths in mm/s (mean, largest)\n"
        " rate  jerk  white  time-correlated error     stated white    true            fitted      "
        "    "
        "certificate\n"
        "   Hz density     mm    mm   tau s    held   half      held   half     held   half     "
        "held   "
        "half "
        "largest\n";
    const auto column = [](const Coverage& coverage) {
        return fmt::format("  {:5.1f} % {:6.1f}", coverage.fraction() * 100.0,
                           coverage.half_width_m_s * 1e3);
    };
    for (const CoverageCell& cell : cells) {
        const StudyNoise& noise = cell.run.noise;
        const bool slow = noise.error_sigma_m > 0.0;
        text += fmt::format("{:5g} {:7g} {:6g} {:5} {:>7}{}{}{}{} {:7.1f}\n", cell.run.rate_hz,
                            cell.run.jerk_density, noise.white_m * 1e3, noise.error_sigma_m * 1e3,
                            slow ? fmt::format("{:g}", noise.error_tau_s) : "-", column(cell.white),
                            column(cell.known), column(cell.fitted), column(cell.bound),
                            cell.bound.largest_half_width_m_s * 1e3);
    }
    return text;
}

}  // namespace runcert
