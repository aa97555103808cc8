#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.h"
#include "motion/speed.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "stages/window/window.h"
#include "witness/arcs.h"

namespace runcert::test {

inline NoiseParameter parameter_of(double value) {
    NoiseParameter parameter;
    parameter.value = value;
    return parameter;
}

/// A noise model as a trajectory says it was estimated with.
inline NoiseSummary summary_of(const EstimationModel& model) {
    NoiseSummary noise;
    noise.status = NoiseBasis::fitted;
    noise.jerk_density.value = model.motion.jerk_density;
    noise.measurement_scale.value = noise.white_scale = model.measurement_scale;
    if (model.error.initial_sigma_m > 1e-4) {
        noise.correlated_error_detected = true;
        noise.error_tau_s = parameter_of(model.error.tau_s);
        noise.error_sigma_m = parameter_of(model.error.initial_sigma_m);
        noise.error_diffusion = parameter_of(model.error.process_density);
    }
    return noise;
}

/// A rule over a window of this length, with floors of nothing.
inline Profile rule_over(double duration_s,
                         SpeedDefinition definition = SpeedDefinition::displacement) {
    Profile profile;
    profile.id = "test";
    profile.duration_s = duration_s;
    profile.definition = definition;
    return profile;
}

/// Fewest draws that the stage takes, for tests of something else.
inline WindowConfig few_draws() {
    WindowConfig config;
    config.duration_tolerance_s = 0.001;
    config.selection_samples = 2;
    config.monte_carlo_trials_max = 100'000;
    return config;
}

/// Distance and speed of the run of [DHD22]: logistic, A = 60 m/s, v0 = 0.01 m/s, t0 = 15 s.
inline double run_distance_m(double time_s) {
    const double c = 60.0 / 0.01 - 1.0;
    const double rate = std::log(c) / 15.0;
    return 60.0 * (time_s + std::log((1.0 + c * std::exp(-rate * time_s)) / (1.0 + c)) / rate);
}

/// Epochs of one arc at 10 Hz along bearing 45 degrees, all usable, with white noise of the stated
/// size on each coordinate.
struct RecordedRun {
    double from_s = 0.0;  ///< of the run of [DHD22]
    double to_s = 40.0;
    double sigma_m = 0.010;
    std::uint64_t seed = 1;
};

inline void append_arc(ScreenedTable& table, const RecordedRun& run) {
    RandomGenerator random(run.seed);
    const std::int64_t arc = table.rows.empty() ? 1 : *table.rows.back().arc + 1;
    const std::int64_t start_ns =
        table.rows.empty() ? 0 : table.rows.back().time.nanoseconds + 2'000'000'000;
    const auto epochs = std::llround(10.0 * (run.to_s - run.from_s)) + 1;
    for (std::int64_t k = 0; k < epochs; ++k) {
        const double along_m =
            run_distance_m(run.from_s + 0.1 * static_cast<double>(k)) / std::numbers::sqrt2;
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(table.rows.size());
        row.time = {start_ns + k * 100'000'000};
        row.east_m = 1000.0 + along_m + run.sigma_m * random.normal();
        row.north_m = 1000.0 + along_m + run.sigma_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = run.sigma_m;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = arc;
        if (k == 0) row.break_before = arc == 1 ? ArcBreak::start : ArcBreak::gap;
    }
}

inline ScreenedTable recorded(const RecordedRun& run) {
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    append_arc(table, run);
    return table;
}

/// What smoothing with a noise model leaves of a screened table, as far as windows need it.
inline TrajectoryTable smoothed_with(const ScreenedTable& screened, const NoiseSummary& noise) {
    TrajectoryTable table;
    table.facts = screened.facts;
    table.estimation.horizontal = AxesEstimation{.noise = noise, .health = {}};
    for (const ScreenedEpoch& row : screened.rows) {
        TrajectoryEpoch& epoch = table.rows.emplace_back();
        epoch.epoch = row.epoch;
        epoch.time = row.time;
        epoch.arc = row.arc;
        epoch.usable = row.usable;
    }
    for (const Arc<2>& arc : arcs_of<2>(screened)) {
        const Chain<2> smoothed = Chain<2>(arc.epochs, model_of(noise));
        for (std::size_t k = 0; k < arc.rows.size(); ++k) {
            const StateVector<2>& state = smoothed.mean(k);
            TrajectoryEpoch& epoch = table.rows[arc.rows[k]];
            epoch.east_m = state(0);
            epoch.north_m = state(1);
            epoch.velocity_east_m_s = state(2);
            epoch.velocity_north_m_s = state(3);
            epoch.acceleration_east_m_s2 = state(4);
            epoch.acceleration_north_m_s2 = state(5);
            epoch.speed_m_s = state.segment<2>(2).norm();
        }
    }
    return table;
}

}  // namespace runcert::test
