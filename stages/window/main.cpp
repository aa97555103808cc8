#include <fmt/format.h>

#include "core/prose.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "stages/window/window.h"

using namespace runcert;

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "window", "The best window of each rule profile", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            std::vector<Profile> profiles;
            for (const std::string& claimed : attempt.profiles)
                profiles.push_back(read_claimed_profile(run.run_dir(), claimed, attempt));
            for (const Receiver& receiver : attempt.receivers) {
                StageRun one = run;
                const ScreenedTable screened =
                    one.read(products::screened, receiver, read_screened);
                const TrajectoryTable trajectory =
                    one.read(products::trajectory, receiver, read_trajectory);
                Windows windows = find_windows(screened, trajectory, profiles,
                                               window_config(attempt, receiver), attempt.course);
                windows.header = one.header();
                one.write(products::windows, receiver, write_windows(windows));
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
