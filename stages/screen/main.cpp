#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/screen/screen.h"

using namespace runcert;

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "screen", "Tests every epoch; marks, never deletes", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            std::vector<EnuTable> tables;
            for (const Receiver& receiver : attempt.receivers)
                tables.push_back(run.read(products::enu, receiver, read_enu));
            std::vector<ScreenedTable> screened = screen_receivers(tables, screen_config(attempt));
            for (std::size_t i = 0; i < screened.size(); ++i) {
                // Each table rests on what was read of all receivers.
                screened[i].header = run.header();
                run.write(products::screened, attempt.receivers[i], write_screened(screened[i]));
                const ScreeningSummary summary = summarise(screened[i].rows);
                run.say(fmt::format("{} of {} epochs usable, in {} {}", summary.usable,
                                    screened[i].rows.size(), summary.arcs,
                                    summary.arcs == 1 ? "arc" : "arcs"));
            }
        });
}
