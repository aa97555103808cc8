#include <benchmark/benchmark.h>

#include <map>

#include "answered.h"
#include "core/random.h"
#include "simulated_arc.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_phases.h"
#include "supposed_errors.h"

// What each witness costs: the chain of stages from screening to the windows, by the positions
// alone and beside each of them. 2,820 epochs, forth and back; an epoch is an item.
namespace runcert {
namespace {

enum Heard { alone, velocities, phases, second_receiver, wheel };

struct WitnessedRun {
    EnuTable table;
    WitnessRecords beside;
    std::optional<PhaseWitness<2>> phases;
    ScreenedTable second_screened;
    std::optional<TrajectoryTable> second;
};

SimulatedRecording shuttle() {
    StudyRun run;
    run.length_s = 281.9;
    run.jerk_density = 0.6;
    run.return_time_s = 10.0;
    run.shuttle = true;
    run.noise = {.white_m = 0.010};
    return simulate_recording(run, 7);
}

WitnessedRun made(Heard heard) {
    static const SimulatedRecording recording = shuttle();
    WitnessedRun run{.table = to_be_screened(recording.screened),
                     .beside = {},
                     .phases = {},
                     .second_screened = {},
                     .second = {}};
    run.table.facts.first_epoch = study_start();
    run.table.facts.georeferenced = true;
    run.table.origin = study_origin();
    RandomGenerator random(11);
    std::vector<SimulatedEpoch> truth(recording.truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
        EnuEpoch& row = run.table.rows[k];
        truth[k].epoch = row.epoch;
        truth[k].time_ms = row.time.nanoseconds / 1'000'000;
        truth[k].true_enu_m.head<2>() = recording.truth[k];
        if (heard == velocities) {
            row.recorded_velocity_east_m_s = recording.velocity[k].x() + 0.05 * random.normal();
            row.recorded_velocity_north_m_s = recording.velocity[k].y() + 0.05 * random.normal();
        }
        if (heard == wheel)
            run.beside.handed_in.series["wheel"].samples.push_back(
                {.time_s = row.time.seconds(),
                 .value = recording.velocity[k].norm() + 0.05 * random.normal()});
    }
    if (heard == wheel) run.beside.handed_in.attempt.wheel.emplace();
    if (heard == phases) {
        const StudyPhases of_run = study_phases(truth, 0.0012, 0.0, 7, run.table);
        run.beside.phases = of_run.phases;
        run.beside.first_of_phases = of_run.first_epoch;
        run.phases = phase_witness<2>(of_run.phases, of_run.first_epoch,
                                      run.table.facts.first_epoch, run.table.origin, 0.6);
    }
    if (heard == second_receiver) {
        EnuTable other = run.table;
        other.facts.receiver = "second";
        for (EnuEpoch& row : other.rows) {
            *row.east_m += 0.010 * random.normal();
            *row.north_m += 0.010 * random.normal();
        }
        run.second_screened = screen(other, study_screen_config());
        run.second = smooth_trajectory(run.second_screened, smooth_config(study_attempt()));
    }
    return run;
}

void judge(benchmark::State& state) {
    static std::map<int, WitnessedRun> runs;
    const auto heard = static_cast<Heard>(state.range(0));
    if (!runs.contains(heard)) runs.emplace(heard, made(heard));
    WitnessedRun& run = runs.at(heard);
    if (run.second)
        run.beside.receivers = {{.screened = &run.second_screened, .trajectory = &*run.second}};
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
    for (auto _ : state) {
        const ScreenedTable screened = screen(
            run.table, study_screen_config(),
            {.phases = run.phases ? &*run.phases : nullptr, .handed_in = run.beside.handed_in});
        const TrajectoryTable trajectory =
            smooth_trajectory(screened, smooth_config(study_attempt()));
        const Windows windows = test::answered(
            find_windows(screened, trajectory, {profile}, config, std::nullopt, run.beside));
        benchmark::DoNotOptimize(windows.profiles.front().best->speed_m_s);
        state.counters["witnesses"] =
            static_cast<double>(windows.profiles.front().best->witnesses.size());
    }
    state.SetItemsProcessed(state.iterations() * std::ssize(run.table.rows));
}

BENCHMARK(judge)
    ->Name("witnesses: none, velocities, phases, second receiver, wheel")
    ->DenseRange(alone, wheel)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace runcert
