#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/enu/enu.h"

using namespace runcert;

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "enu", "WGS 84 positions to local east, north, up at a declared origin",
        [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            for (const Receiver& receiver : attempt.receivers) {
                StageRun one = run;
                const Observations observations = one.read(
                    "observations", product_file(attempt, receiver, "1-observations", "ecsv"),
                    read_observations);
                EnuTable table = to_enu(observations, attempt.origin);
                table.header = one.header();
                one.write(product_file(attempt, receiver, "2-enu", "ecsv"), write_enu(table));
                run.say(table.origin ? fmt::format("origin {:.6f} {:.6f}, height {:.1f} m",
                                                   table.origin->position.latitude.degrees(),
                                                   table.origin->position.longitude.degrees(),
                                                   table.origin->position.height_m)
                                     : std::string("local plane: not georeferenced"));
            }
        });
}
