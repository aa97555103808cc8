#include "selection_study.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "core/uncertainty.h"
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

SelectionStudy study_selection(const StudyRun& run, std::int64_t runs, std::uint64_t seed) {
    const std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    std::vector<double> errors;
    std::vector<double> corrected;
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
        const double true_mps =
            (recording.truth[last] - recording.truth[first]).norm() / best.span.duration.seconds();
        const double taken_off_mps =
            best.selection->treatment == "subtracted" ? best.selection->bias_mps : 0.0;
        corrected.push_back(best.speed_mps + taken_off_mps - best.selection->bias_mps - true_mps);
        errors.push_back(best.speed_mps + taken_off_mps - true_mps);
        const double expanded_mps =
            best.standard_uncertainty_mps *
                equivalent_coverage_factor(profiles.front().coverage_factor,
                                           best.effective_degrees_of_freedom) +
            best.bias_limit_mps;
        held += std::abs(best.speed_mps - true_mps) <= expanded_mps ? 1 : 0;
    }
    const double root = std::sqrt(static_cast<double>(runs));
    return {.run = run,
            .runs = runs,
            .mean_mps = mean(errors),
            .standard_error_mps = standard_deviation(errors) / root,
            .corrected_mean_mps = mean(corrected),
            .corrected_standard_error_mps = standard_deviation(corrected) / root,
            .held = held};
}

std::string selection_line(const SelectionStudy& study) {
    return fmt::format(
        "{:g} Hz, jerk density {:g}, noise {:g} mm, {} runs: without correction less true {:+.3f} "
        "+- {:.3f} mm/s; with the reported bias "
        "taken off {:+.3f} +- {:.3f} mm/s (means and their standard errors); within U {:.1f} %\n",
        study.run.rate_hz, study.run.jerk_density, study.run.noise.white_m * 1e3, study.runs,
        study.mean_mps * 1e3, study.standard_error_mps * 1e3, study.corrected_mean_mps * 1e3,
        study.corrected_standard_error_mps * 1e3,
        100.0 * static_cast<double>(study.held) / static_cast<double>(study.runs));
}

}  // namespace runcert
