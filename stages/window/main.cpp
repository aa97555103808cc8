#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/prose.h"
#include "estimation/tables/screened_phases.h"
#include "run/attempt_files.h"
#include "run/handed_in_series.h"
#include "run/stage_main.h"
#include "stages/window/window.h"

using namespace runcert;

namespace {

/// What the window of a receiver is found from.
struct ReceiverTables {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    std::shared_ptr<const JudgedPhases> phases;
    GpsTime first_of_phases;
};

void read_phases(StageRun& run, const Receiver& receiver, ReceiverTables& tables) {
    const ScreenedTable& screened = tables.screened;
    auto phases = run.open(products::phase, receiver, open_phase);
    auto judged = run.open(products::screened_phase, receiver, open_screened_phase);
    tables.first_of_phases = phases.head().first_epoch;
    tables.phases = std::make_shared<const JudgedPhases>(judged_phases(
        phases, judged, ReceiverPlaces(screened.origin, screened.facts.first_epoch, screened.rows),
        run.attempt().parameters.screen.phase_mask_deg));
}

ReceiverTables read_tables(StageRun& run, const Receiver& receiver) {
    ReceiverTables tables{.screened = run.read(products::screened, receiver, read_screened),
                          .trajectory = run.read(products::trajectory, receiver, read_trajectory),
                          .phases = nullptr,
                          .first_of_phases = {}};
    if (has_phases(receiver)) read_phases(run, receiver, tables);
    return tables;
}

/// Wheel and gates, which are of the first receiver's craft and on its time.
void read_handed_in(StageRun& run, const std::optional<GpsTime>& first_epoch, Beside& beside) {
    if (const auto wheel = handed_in_series(run, "wheel", first_epoch)) {
        beside.wheel = {.m_s = timed_values(*wheel),
                        .calibrated_scale = run.attempt().wheel->scale,
                        .sigma_calibrated =
                            0.5 * run.attempt().wheel->expanded_uncertainty_scale.value_or(0.0)};
        if (!wheel->left_out.empty()) beside.notes.push_back(wheel->left_out);
    }
    if (const auto gates = handed_in_series(run, "gates", first_epoch)) {
        beside.gates_m = timed_values(*gates);
        const GateSeries& stated = *run.attempt().gates;
        beside.gate_errors = {.sigma_distance_m = 0.5 * stated.expanded_uncertainty_m,
                              .sigma_time_s = 0.5 * stated.expanded_uncertainty_s};
    }
}

Beside beside(StageRun& run, const std::vector<ReceiverTables>& tables, std::size_t own) {
    Beside all{.phases = tables[own].phases, .first_of_phases = tables[own].first_of_phases};
    if (own == 0) read_handed_in(run, tables[own].trajectory.facts.first_epoch, all);
    const auto& baseline = tables[own].screened.basis.baseline;
    for (std::size_t i = 0; i < tables.size(); ++i)
        if (i != own && !(baseline && baseline->same_errors))
            all.receivers.push_back(
                {.screened = &tables[i].screened, .trajectory = &tables[i].trajectory});
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "window", "The best window of each rule profile", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            const std::vector<Profile> profiles = run.read_profiles();
            std::vector<ReceiverTables> tables;
            for (const Receiver& receiver : attempt.receivers)
                tables.push_back(read_tables(run, receiver));
            for (std::size_t i = 0; i < tables.size(); ++i) {
                const Receiver& receiver = attempt.receivers[i];
                Windows windows = find_windows(tables[i].screened, tables[i].trajectory, profiles,
                                               window_config(attempt, receiver), attempt.course,
                                               beside(run, tables, i));
                // Each file rests on what was read of all receivers.
                windows.header = run.header();
                run.write(products::windows, receiver, write_windows(windows));
                for (const std::string& note : windows.witness_notes)
                    run.say(note);
                for (const ProfileWindows& entry : windows.profiles)
                    run.say(entry.best
                                ? fmt::format("{}: best of {} from {:.3f} s", entry.profile,
                                              counted(entry.candidates, "window"),
                                              entry.best->span.start.seconds())
                                : fmt::format("{}: no certifiable window{}{}", entry.profile,
                                              entry.missing.empty() ? "" : ": ", entry.missing));
            }
        });
}
