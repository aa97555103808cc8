#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/screen/screen.h"

using namespace runcert;

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "screen", "Tests every epoch; marks, never deletes", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            for (const Receiver& receiver : attempt.receivers) {
                StageRun one = run;
                const EnuTable table =
                    one.read("enu", product_file(attempt, receiver, "2-enu", "ecsv"), read_enu);
                ScreenedTable screened = screen(table, screen_config(attempt));
                screened.header = one.header();
                one.write(product_file(attempt, receiver, "3-screened", "ecsv"),
                          write_screened(screened));
                const ScreeningSummary summary = summarise(screened.rows);
                run.say(fmt::format("{} of {} epochs usable, in {} {}", summary.usable,
                                    screened.rows.size(), summary.arcs,
                                    summary.arcs == 1 ? "arc" : "arcs"));
            }
        });
}
