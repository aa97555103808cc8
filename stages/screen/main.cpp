#include <fmt/format.h>

#include <optional>

#include "estimation/tables/phase_rows.h"
#include "files/atomic_file.h"
#include "run/stage_main.h"
#include "stages/screen/phases.h"
#include "stages/screen/screen.h"

using namespace runcert;

namespace {

/// The raw phases of a receiver, as they are read.
struct RawPhases {
    PhaseTable head;
    PhaseRecord record;
};

RawPhases read_phases(StageRun& run, const Receiver& receiver) {
    auto rows = run.open(products::phase, receiver, open_phase);
    PhaseRecordBuilder builder(rows.head());
    for (PhaseRow row; rows.next(row);)
        builder.add(row);
    return {rows.head(), std::move(builder).take()};
}

void screen_phases_of(StageRun& run, const Receiver& receiver, RawPhases raw,
                      const EnuTable& positions) {
    ScreenedPhases screened = screen_receiver_phases(raw.head, std::move(raw.record), positions,
                                                     phase_screening_config(run.attempt()));
    screened.head.header = run.header();
    AtomicFile file(run.run_dir() / run.file_of(products::screened_phase, receiver));
    TableWriter<ScreenedPhase> table =
        begin_screened_phase(screened.head, [&](std::string_view piece) { file.write(piece); });
    give_screened_rows(screened, [&](const ScreenedPhase& row) { table.write(row); });
    table.finish();
    file.commit();
    run.say(fmt::format("Phases: {} slips, {} of {} pairs of epochs refused", screened.head.slips,
                        screened.head.refusals, screened.head.pairs));
    for (const std::string& note : screened.head.notes)
        run.say(note);
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "screen", "Tests every epoch; marks, never deletes", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            std::vector<EnuTable> tables;
            std::vector<std::optional<RawPhases>> phases;
            for (const Receiver& receiver : attempt.receivers) {
                tables.push_back(run.read(products::enu, receiver, read_enu));
                phases.emplace_back();
                if (has_phases(receiver)) phases.back() = read_phases(run, receiver);
            }
            std::vector<ScreenedTable> screened = screen_receivers(tables, screen_config(attempt));
            for (std::size_t i = 0; i < screened.size(); ++i) {
                // Each table rests on what was read of all receivers.
                screened[i].header = run.header();
                run.write(products::screened, attempt.receivers[i], write_screened(screened[i]));
                const ScreeningSummary summary = summarise(screened[i].rows);
                run.say(fmt::format("{} of {} epochs usable, in {} {}", summary.usable,
                                    screened[i].rows.size(), summary.arcs,
                                    summary.arcs == 1 ? "arc" : "arcs"));
                if (phases[i])
                    screen_phases_of(run, attempt.receivers[i], *std::move(phases[i]), tables[i]);
            }
        });
}
