#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/smooth/smooth.h"

using namespace runcert;

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "smooth",
        "Position, velocity and acceleration by RTS smoothing and by batch "
        "least squares, which must agree",
        [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            for (const Receiver& receiver : attempt.receivers) {
                StageRun one = run;
                const ScreenedTable screened =
                    one.read("screened", product_file(attempt, receiver, "3-screened", "ecsv"),
                             read_screened);
                TrajectoryTable table = smooth_trajectory(screened, smooth_config(attempt));
                table.header = one.header();
                one.write(product_file(attempt, receiver, "4-trajectory", "ecsv"),
                          write_trajectory(table));
                run.say(
                    table.estimation.arcs == 0
                        ? "nothing to estimate: no usable stretch"
                        : fmt::format("smoother and batch agree within {:.1e} m and {:.1e} m/s, "
                                      "variance factor {:.2f}",
                                      table.estimation.largest_position_difference_m,
                                      table.estimation.largest_velocity_difference_mps,
                                      table.estimation.variance_factor));
            }
        });
}
