#include <benchmark/benchmark.h>

#include <chrono>

#include "core/random.h"
#include "simulated_arc.h"
#include "stages/screen/screen.h"
#include "witness/arcs.h"

// Screening against one pass of filter and smoother over the same recording, run in turns: the
// counter `passes` is how many of those it costs.

namespace runcert::RUNCERT_FILE {
namespace {

double seconds_of(const auto& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

ScreenConfig config() {
    return screen_config(
        read_attempt("schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
                     "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
                     "attempt"));
}

/// A recording at 20 Hz; every `outlier_every`-th position is wrong by half a metre.
EnuTable recording(std::int64_t epochs, bool heights, std::int64_t outlier_every) {
    StudyRun run;
    run.rate_hz = 20.0;
    run.length_s = static_cast<double>(epochs - 1) / run.rate_hz;
    run.jerk_density = 0.0;
    run.noise = {.white_m = 0.003, .error_sigma_m = 0.008, .error_tau_s = 2.0};
    const SimulatedRecording simulated = simulate_recording(run, 1);
    EnuTable table;
    table.facts = simulated.screened.facts;
    table.facts.vertical_measured = heights;
    RandomGenerator random(2);
    for (const ScreenedEpoch& row : simulated.screened.rows) {
        EnuEpoch& epoch = table.rows.emplace_back(row);
        if (heights) {
            epoch.up_m = 0.006 * random.normal();
            epoch.sigma_up_m = 0.006;
        }
        if (outlier_every > 0 && row.epoch % outlier_every == 0) *epoch.north_m += 0.5;
    }
    return table;
}

void screening_in_passes(benchmark::State& state, bool heights, std::int64_t outlier_every) {
    const EnuTable table = recording(state.range(0), heights, outlier_every);
    const ScreenConfig figures = config();
    ScreenedTable all;
    all.facts = table.facts;
    for (const EnuEpoch& row : table.rows) {
        ScreenedEpoch& epoch = all.rows.emplace_back();
        static_cast<EnuEpoch&>(epoch) = row;
        epoch.usable = true;
        epoch.arc = 1;
    }
    EstimationModel model;
    model.motion.jerk_density = figures.jerk_density;
    const auto plane = arcs_of<2>(all);
    const auto height = heights ? arcs_of<1>(all) : std::vector<Arc<1>>{};
    double screening_s = 0.0;
    double passes_s = 0.0;
    for (auto _ : state) {
        passes_s += seconds_of([&] {
            benchmark::DoNotOptimize(Chain<2>(plane.front().epochs, model));
            if (heights) benchmark::DoNotOptimize(Chain<1>(height.front().epochs, model));
        });
        screening_s += seconds_of([&] { benchmark::DoNotOptimize(screen(table, figures)); });
    }
    state.counters["passes"] = screening_s / passes_s;
    state.counters["us_per_epoch"] =
        1e6 * screening_s / static_cast<double>(state.iterations() * state.range(0));
}

BENCHMARK_CAPTURE(screening_in_passes, in_the_plane, false, 0)
    ->Arg(7050)
    ->Arg(14100)
    ->Arg(28200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(screening_in_passes, with_heights, true, 0)
    ->Arg(28200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(screening_in_passes, one_outlier_in_a_hundred, false, 100)
    ->Arg(28200)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace runcert::RUNCERT_FILE
