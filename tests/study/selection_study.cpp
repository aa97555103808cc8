#include "selection_study.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "simulated_arc.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

namespace runcert {

StudyRun selection_run(double noise_m, double rate_hz, double jerk_density) {
    return {.rate_hz = rate_hz,
            .length_s = 45.0,
            .jerk_density = jerk_density,
            .noise = {.white_m = noise_m}};
}

namespace {

MeanError mean_error(const std::vector<double>& errors) {
    return {.mean_m_s = mean(errors),
            .standard_error_m_s =
                standard_deviation(errors) / std::sqrt(static_cast<double>(errors.size()))};
}

std::string in_millimetres(const MeanError& error) {
    return fmt::format("{:+.3f} +- {:.3f}", error.mean_m_s * 1e3, error.standard_error_m_s * 1e3);
}

}  // namespace

SelectionStudy study_selection(const StudyRun& run, std::int64_t runs, std::uint64_t seed) {
    const std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    std::vector<double> uncorrected;
    std::vector<double> less_fitted;
    std::vector<double> less_reported;
    std::vector<double> half_ranges;
    std::int64_t held = 0;
    for (std::int64_t i = 0; i < runs; ++i) {
        const SimulatedRecording recording =
            simulate_recording(run, seed * 1'000'003 + static_cast<std::uint64_t>(i));
        const TrajectoryTable trajectory = smooth_trajectory(recording.screened, SmoothConfig{});
        WindowConfig config;
        config.duration_tolerance_s = 0.001;
        config.seed = i + 1;
        const Windows windows = find_windows(recording.screened, trajectory, profiles, config);
        const CertifiableWindow& best = windows.profiles.front().best.value();
        const auto first = static_cast<std::size_t>(best.span.first_epoch) - 1;
        const auto last = static_cast<std::size_t>(best.span.last_epoch) - 1;
        const double true_m_s =
            (recording.truth[last] - recording.truth[first]).norm() / best.span.duration.seconds();
        const double taken_off_m_s = best.selection->treatment == SelectionTreatment::subtracted
                                         ? best.selection->bias_m_s
                                         : 0.0;
        const double error_m_s = best.speed_m_s + taken_off_m_s - true_m_s;
        uncorrected.push_back(error_m_s);
        less_fitted.push_back(error_m_s - best.selection->fitted_bias_m_s);
        less_reported.push_back(error_m_s - best.selection->bias_m_s);
        half_ranges.push_back(best.selection->bias_half_range_m_s);
        const double expanded_m_s =
            expanded_uncertainty_by_rule_m_s(best, profiles.front().coverage_factor);
        held += std::abs(best.speed_m_s - true_m_s) <= expanded_m_s ? 1 : 0;
    }
    return {.run = run,
            .runs = runs,
            .uncorrected = mean_error(uncorrected),
            .fitted = mean_error(less_fitted),
            .reported = mean_error(less_reported),
            .half_range_m_s = mean(half_ranges),
            .held = held};
}

std::string selection_line(const SelectionStudy& study) {
    return fmt::format(
        "{:g} Hz, jerk density {:g}, noise {:g} mm, {} runs: without correction less true {} mm/s; "
        "with the bias by the fitted errors taken off {} mm/s; with the reported one {} mm/s, "
        "allowed +- {:.3f} mm/s (means and their standard errors); within U {:.1f} %\n",
        study.run.rate_hz, study.run.jerk_density, study.run.noise.white_m * 1e3, study.runs,
        in_millimetres(study.uncorrected), in_millimetres(study.fitted),
        in_millimetres(study.reported), study.half_range_m_s * 1e3,
        100.0 * static_cast<double>(study.held) / static_cast<double>(study.runs));
}

}  // namespace runcert
