#include "selection_study.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "simulated_arc.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

namespace runcert {

SelectionStudy study_selection(double noise_m, std::int64_t runs, std::uint64_t seed) {
    const std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    std::vector<double> errors;
    std::vector<double> corrected;
    for (std::int64_t i = 0; i < runs; ++i) {
        const SimulatedRecording recording = simulate_recording(
            {.rate_hz = 10.0, .length_s = 45.0, .jerk_density = 0.0, .noise = {.white_m = noise_m}},
            seed * 1'000'003 + static_cast<std::uint64_t>(i));
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
        errors.push_back(best.speed_mps - true_mps);
        corrected.push_back(best.speed_mps - best.selection->bias_mps - true_mps);
    }
    const double root = std::sqrt(static_cast<double>(runs));
    return {.noise_m = noise_m,
            .runs = runs,
            .mean_mps = mean(errors),
            .standard_error_mps = standard_deviation(errors) / root,
            .corrected_mean_mps = mean(corrected),
            .corrected_standard_error_mps = standard_deviation(corrected) / root};
}

std::string selection_line(const SelectionStudy& study) {
    return fmt::format(
        "noise {:g} mm, {} runs: stated less true {:+.3f} +- {:.3f} mm/s; with the reported bias "
        "taken off {:+.3f} +- {:.3f} mm/s (means and their standard errors)\n",
        study.noise_m * 1e3, study.runs, study.mean_mps * 1e3, study.standard_error_mps * 1e3,
        study.corrected_mean_mps * 1e3, study.corrected_standard_error_mps * 1e3);
}

}  // namespace runcert
