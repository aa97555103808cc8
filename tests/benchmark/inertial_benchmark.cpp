#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "simulation/inertial_run.h"

// An afternoon's positions beside a 100 Hz IMU: 28,200 epochs at 10 Hz, smoothed with all passes.
namespace runcert {
namespace {

void BM_SmoothInertial(benchmark::State& state) {
    InertialRunSpec spec;
    spec.course = state.range(0) == 0 ? InertialCourse::salt_lake : InertialCourse::oval;
    spec.noise = imu_noise(ImuGrade::mems);
    spec.duration_s = 2821.0;
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
    // Of the first benchmark that runs: later ones find the memory taken.
    state.counters["peak_MiB"] = peak_mib() - before_mib;
}
BENCHMARK(BM_SmoothInertial)->Arg(0)->Arg(1)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace runcert
