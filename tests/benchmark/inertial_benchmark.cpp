#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "simulation/inertial_run.h"

// An afternoon's positions beside a 100 Hz IMU: 28,200 epochs at 10 Hz, smoothed with all passes.
namespace runcert {
namespace {

void BM_SmoothInertial(benchmark::State& state) {
    InertialRunSpec spec;
    spec.course = InertialCourse::oval;
    spec.noise = imu_noise(ImuClass::mems);
    spec.duration_s = 2821.0;
    if (state.range(0) == 1) spec.time_offset_s = 0.05;  // innovations ask for it
    const InertialRun run = simulate_inertial(spec);
    const auto peak_mib = [] {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return static_cast<double>(usage.ru_maxrss) / 1024.0;
    };
    const double before_mib = peak_mib();
    for (auto _ : state) {
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        state.counters["epochs"] = static_cast<double>(solution.epochs.size());
        state.counters["passes"] = solution.passes;
        state.counters["nis"] = solution.consistency.nis;
    }
    state.counters["peak_MiB"] = peak_mib() - before_mib;
}
// By --benchmark_filter=/0 or /1, each in a process of its own.
BENCHMARK(BM_SmoothInertial)->Arg(0)->Arg(1)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace runcert
