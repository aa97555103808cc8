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
    ReceiverFindings found;
    do_together(
        [&] {
            observations.read_to_end();
            enu.read_to_end();
        },
        [&] {
            TrajectoryTable trajectory = run.read(products::trajectory, receiver, read_trajectory);
            found.estimation = std::move(trajectory.estimation);
            found.origin = trajectory.origin;
            found.trajectory = std::move(trajectory.rows);
            found.windows = run.read(products::windows, receiver, read_windows);
            for (ScreenedEpoch row; screened.next(row);)
                found.add(row, found.windows);
        });
    static_cast<Observations&>(found) = observations.head();
    found.receiver = receiver.id;
    found.tests = screened.head().basis;
    found.ground = read_ground(run, receiver, found.origin);
    return found;
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
