#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/enu/enu.h"

using namespace runcert;

namespace {

/// Row by row: neither table is held in memory.
void convert(StageRun& run, const Receiver& receiver) {
    StageRun one = run;
    const Attempt& attempt = run.attempt();
    auto observations = one.open(products::observations, receiver, open_observations);
    const RecordingFacts& facts = observations.head().facts;
    FirstPosition first;
    if (ToLocalFrame::needs_first_position(facts, attempt.origin))
        observations.look_ahead([&first](const Observation& row) { first.see(row); });
    ToLocalFrame to_local(facts, attempt.origin, first.position());
    const EnuTable head{
        .header = one.header(), .facts = facts, .origin = to_local.origin(), .rows = {}};
    AtomicFile file(run.run_dir() / run.file_of(products::enu, receiver));
    TableWriter<EnuEpoch> table =
        begin_enu(head, [&file](std::string_view piece) { file.write(piece); });
    for (Observation row; observations.next(row);)
        table.write(to_local(row));
    to_local.finish();
    table.finish();
    file.commit();
    run.say(head.origin ? fmt::format("origin {:.6f} {:.6f}, height {:.1f} m",
                                      head.origin->position.latitude.degrees(),
                                      head.origin->position.longitude.degrees(),
                                      head.origin->position.height_m)
                        : std::string("engineering CRS: not georeferenced"));
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(argc, argv, "enu",
                      "WGS 84 positions to local east, north, up at a declared origin",
                      [](StageRun& run) {
                          for (const Receiver& receiver : run.attempt().receivers)
                              convert(run, receiver);
                      });
}
