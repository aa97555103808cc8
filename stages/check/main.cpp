#include <fmt/format.h>

#include "core/parallel.h"
#include "run/attempt_files.h"
#include "run/handed_in_series.h"
#include "run/stage_main.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "stages/check/check.h"
#include "witness/surface_input.h"

using namespace runcert;

namespace {

std::optional<CourseGround> read_ground(StageRun& run, const Receiver& receiver,
                                        const std::optional<FrameOrigin>& origin) {
    if (!has_surface(receiver)) return std::nullopt;
    const SurfaceTable table = run.read(products::surface, receiver, read_surface);
    return CourseGround{.surface = surface_of(table, origin), .vertical_sd_m = table.vertical_sd_m};
}

ReceiverFindings gather(StageRun& run, const Receiver& receiver) {
    // Every table is read whole, which checks its values; what is not used of it is not kept.
    auto observations = run.open(products::observations, receiver, open_observations);
    auto enu = run.open(products::enu, receiver, open_enu);
    auto screened = run.open(products::screened, receiver, open_screened);
    TrajectoryTable trajectory;
    Windows windows;
    ScreenedSelection selection;
    do_together(
        [&] {
            observations.read_to_end();
            enu.read_to_end();
        },
        [&] {
            trajectory = run.read(products::trajectory, receiver, read_trajectory);
            windows = run.read(products::windows, receiver, read_windows);
            for (ScreenedEpoch row; screened.next(row);)
                selection.add(row, windows);
        });
    auto ground = read_ground(run, receiver, trajectory.origin);
    return {.receiver = receiver.id,
            .facts = observations.head().facts,
            .accuracy_source = observations.head().accuracy_source,
            .format = observations.head().format,
            .time_origin = observations.head().time_origin,
            .written_by = observations.head().written_by,
            .simulated = observations.head().simulated,
            .processing = observations.head().processing,
            .solution_source = observations.head().solution_source,
            .records = observations.head().records,
            .screening = std::move(selection.summary),
            .tests = screened.head().basis,
            .estimation = trajectory.estimation,
            .windows = std::move(windows),
            .origin = trajectory.origin,
            .trajectory = std::move(trajectory.rows),
            .ground = std::move(ground),
            .window_epochs = std::move(selection.window_epochs),
            .further_epochs = std::move(selection.further_epochs)};
}

void say_verdict(StageRun& run, const Verdict& verdict) {
    for (const ProfileVerdict& profile : verdict.profiles)
        run.say(fmt::format(
            "{}: {}{}. {}", profile.profile, outcome_words(state_of(profile)).title,
            profile.shown ? fmt::format(" ({})", measured_speed_text(*profile.shown)) : "",
            profile.reason));
}

void check_run(StageRun& run) {
    run.note_attempt();
    const std::vector<Profile> profiles = read_claimed_rules(run.run_dir(), run.attempt());
    for (const std::string& claimed : run.attempt().profiles)
        run.read_text("profile", profile_copy_name(claimed));
    std::vector<ReceiverFindings> receivers;
    for (const Receiver& receiver : run.attempt().receivers)
        receivers.push_back(gather(run, receiver));
    const auto& first_epoch = receivers.front().facts.first_epoch;
    const auto wind = handed_in_series(run, "wind", first_epoch);
    const auto current = handed_in_series(run, "current", first_epoch);
    Verdict verdict = check({.attempt = run.attempt(),
                             .profiles = profiles,
                             .judged = receivers.front(),
                             .secondary = receivers.size() > 1 ? &receivers[1] : nullptr,
                             .wind = wind ? &*wind : nullptr,
                             .current = current ? &*current : nullptr});
    verdict.header = run.header();
    run.write(products::verdict, run.attempt().receivers.front(), write_verdict(verdict));
    say_verdict(run, verdict);
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(argc, argv, "check",
                      "Every requirement of each rule profile, and the outcome", check_run);
}
