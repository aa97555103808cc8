#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/prose.h"
#include "run/attempt_files.h"
#include "run/handed_in_series.h"
#include "run/stage_main.h"
#include "schemas/attitude/declared.h"
#include "stages/window/craft_speeds.h"
#include "stages/window/window.h"
#include "stages/window/window_courses.h"
#include "witness/gyro_noise.h"
#include "witness/inertial_input.h"
#include "witness/screened_phases.h"

using namespace runcert;

namespace {

/// The inputs for the windows of one receiver.
struct ReceiverTables {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    std::shared_ptr<const JudgedPhases> phases;
    GpsTime first_of_phases;
    std::optional<ImuTable> imu = {};
    /// By IMU and positions; empty if there is no solution. Null without an IMU.
    std::shared_ptr<const InertialSolution> inertial = nullptr;
    std::vector<std::string> attitude_notes = {};
    std::vector<StillSpan> still = {};  ///< where the IMU felt that the craft stood
};

void read_phases(StageRun& run, const Receiver& receiver, ReceiverTables& tables) {
    const ScreenedTable& screened = tables.screened;
    auto phases = run.open(products::phase, receiver, open_phase);
    auto judged = run.open(products::screened_phase, receiver, open_screened_phase);
    tables.first_of_phases = phases.head().first_epoch;
    tables.phases = std::make_shared<const JudgedPhases>(judged_phases(
        phases, judged, ReceiverTrack(screened.origin, screened.facts.first_epoch, screened.rows),
        run.attempt().parameters.screen.phase_mask_deg));
}

/// Where the IMU felt that the craft stood, at speeds by the trajectory.
std::vector<StillSpan> still_by_imu(const InertialInput& input, const TrajectoryTable& trajectory) {
    std::vector<TimedValue> speeds;
    for (const TrajectoryEpoch& row : trajectory.rows)
        if (row.speed_m_s) speeds.push_back({row.time.seconds(), *row.speed_m_s});
    return still_spans(input.samples, [&](double time_s) {
        return value_at(speeds, time_s, 2.0).value_or(std::numeric_limits<double>::quiet_NaN());
    });
}

/// The solution that 4-attitude has, with the covariances between its epochs; empty if it has
/// none.
std::shared_ptr<const InertialSolution> inertial_solution(InertialInput input,
                                                          const AttitudeTable& attitude) {
    if (attitude.consistency.epochs == 0) return std::make_shared<const InertialSolution>();
    take_solution(attitude, input.setup);
    InertialSolution solution = smooth_inertial(input.samples, input.fixes, input.setup);
    const InertialStanding standing = attitude.consistency.standing;
    if (standing != InertialStanding::consistent)
        solution.consistency.doubts.push_back(
            {.finding = standing == InertialStanding::noise_too_large
                            ? InertialFinding::noise_large
                            : InertialFinding::innovations_large});
    return std::make_shared<const InertialSolution>(std::move(solution));
}

ReceiverTables read_tables(StageRun& run, const Receiver& receiver) {
    ReceiverTables tables{.screened = run.read(products::screened, receiver, read_screened),
                          .trajectory = run.read(products::trajectory, receiver, read_trajectory),
                          .phases = nullptr,
                          .first_of_phases = {}};
    if (has_phases(receiver)) read_phases(run, receiver, tables);
    if (has_imu(receiver)) tables.imu = run.read(products::imu, receiver, read_imu);
    return tables;
}

/// Solves each receiver's IMU. The second receiver's antenna shows the heading of the first, where
/// both have a place on the craft.
void solve_imus(StageRun& run, std::vector<ReceiverTables>& tables) {
    const Attempt& attempt = run.attempt();
    const Receiver* const other = second_on_craft(attempt);
    for (std::size_t i = 0; i < tables.size(); ++i) {
        if (!tables[i].imu) continue;
        const auto second =
            other && i == 0 ? std::optional(SecondAntenna{tables[1].screened, *other->lever_arm})
                            : std::nullopt;
        InertialInput input =
            inertial_input(*tables[i].imu, tables[i].screened, tables[i].trajectory, second);
        tables[i].still = still_by_imu(input, tables[i].trajectory);
        const AttitudeTable attitude =
            run.read(products::attitude, attempt.receivers[i], read_attitude);
        tables[i].attitude_notes = attitude.notes;
        tables[i].inertial = inertial_solution(std::move(input), attitude);
    }
}

WitnessRecords witness_records(StageRun& run, const std::vector<ReceiverTables>& tables,
                               std::size_t own) {
    WitnessRecords all{.phases = tables[own].phases,
                       .first_of_phases = tables[own].first_of_phases,
                       .inertial = tables[own].inertial,
                       .still_by_imu = tables[own].still,
                       .own_phases = run.attempt().receivers[own].phase.empty()};
    // Series handed in belong to the first receiver's craft and use its time.
    if (own == 0)
        all.handed_in = {run.attempt(),
                         all_handed_in_series(run, tables[own].trajectory.facts.first_epoch)};
    all.antenna_motion = run.attempt().receivers[own].antenna_motion;
    const auto& baseline = tables[own].screened.basis.baseline;
    for (std::size_t i = 0; i < tables.size(); ++i)
        if (i != own && !(baseline && baseline->same_errors))
            all.receivers.push_back(
                {.screened = &tables[i].screened, .trajectory = &tables[i].trajectory});
    return all;
}

/// The lever arm between antenna and reference point, as the attempt states both from the IMU.
Eigen::Vector3d lever_arm_of(const ImuTable& imu) {
    const LeverArm reference = imu.reference_point.value_or(LeverArm{});
    return Eigen::Vector3d(reference.data()) - Eigen::Vector3d(imu.antenna.data());
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
            solve_imus(run, tables);
            for (std::size_t i = 0; i < tables.size(); ++i) {
                const Receiver& receiver = attempt.receivers[i];
                WindowConfig config = window_config(attempt, receiver);
                if (tables[i].imu) config.lever_arm = lever_arm_of(*tables[i].imu);
                Windows windows =
                    find_windows(tables[i].screened, tables[i].trajectory, profiles, config,
                                 attempt.course, witness_records(run, tables, i));
                if (tables[i].imu)
                    if (std::string quiet = quiet_gyros_text(*tables[i].imu, *receiver.imu);
                        !quiet.empty())
                        windows.witness_notes.push_back(std::move(quiet));
                if (tables[i].inertial) {
                    add_craft_speeds(*tables[i].inertial, profiles, windows);
                    add_headings(*tables[i].inertial, windows);
                }
                std::ranges::copy(tables[i].attitude_notes,
                                  std::back_inserter(windows.witness_notes));
                // Each file depends on the data of all receivers.
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
