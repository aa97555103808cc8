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
    if (to_local.origin()) {
        Places places(to_local.origin()->position);
        observations.look_ahead([&places](const Observation& row) { places.see(row); });
        to_local.set_receiver_positions(places.found());
    }
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
    if (!head.origin) {
        run.say("engineering CRS: not georeferenced");
        return;
    }
    for (std::size_t number = 0; number <= head.origin->places.size(); ++number) {
        const FramePlace place = head.origin->place(number);
        run.say(fmt::format(
            "origin {:.6f} {:.6f}, height {:.1f} m{}", place.position.latitude.degrees(),
            place.position.longitude.degrees(), place.position.height_m,
            number == 0 ? std::string() : fmt::format(", from {:.1f} s on", place.from.seconds())));
    }
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
