#include <fmt/format.h>

#include <optional>

#include "core/text.h"
#include "run/handed_in_series.h"
#include "run/stage_main.h"
#include "stages/screen/phases.h"
#include "stages/screen/screen.h"
#include "store/atomic_file.h"
#include "witness/phase_rows.h"
#include "witness/surface_input.h"

using namespace runcert;

namespace {

ScreenedPhases read_and_screen_phases(StageRun& run, const Receiver& receiver,
                                      const EnuTable& positions) {
    auto rows = run.open(products::phase, receiver, open_phase);
    PhaseRecordBuilder builder(rows.head());
    for (PhaseRow row; rows.next(row);)
        builder.add(row);
    return screen_receiver_phases(rows.head(), std::move(builder).take(), positions,
                                  phase_screening_config(run.attempt()));
}

void write_phases(StageRun& run, const Receiver& receiver, ScreenedPhases& screened) {
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

std::optional<GroundBelow> read_ground(StageRun& run, const Receiver& receiver,
                                       const EnuTable& positions) {
    if (!has_surface(receiver)) return std::nullopt;
    const SurfaceTable table = run.read(products::surface, receiver, read_surface);
    return GroundBelow{.surface = surface_of(table, positions.origin),
                       .vertical_sd_m = table.vertical_sd_m,
                       .antenna_height_m = receiver.antenna_height_m.value_or(0.0),
                       .tilt_max_deg = receiver.surface->tilt_max_deg,
                       .undulation_m = table.undulation_m,
                       .place = receiver.surface->place};
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(
        argc, argv, "screen", "Tests every epoch; marks, never deletes", [](StageRun& run) {
            const Attempt& attempt = run.attempt();
            const ScreenConfig config = screen_config(attempt);
            std::vector<EnuTable> tables;
            std::vector<std::optional<ScreenedPhases>> phases;
            std::vector<std::optional<PhaseWitness<2>>> phase_witnesses;
            std::vector<std::optional<GroundBelow>> grounds;
            for (const Receiver& receiver : attempt.receivers) {
                const EnuTable& table =
                    tables.emplace_back(run.read(products::enu, receiver, read_enu));
                grounds.push_back(read_ground(run, receiver, table));
                auto& own = phases.emplace_back();
                auto& witness = phase_witnesses.emplace_back();
                if (!has_phases(receiver)) continue;
                own = read_and_screen_phases(run, receiver, table);
                witness = own->witness<2>(table, config.jerk_density);
            }
            std::vector<ScreeningWitnesses> witnesses;
            for (std::size_t i = 0; i < phase_witnesses.size(); ++i)
                witnesses.push_back({.phases = phase_witnesses[i] ? &*phase_witnesses[i] : nullptr,
                                     .handed_in = {},
                                     .ground = grounds[i] ? &*grounds[i] : nullptr});
            // Series handed in belong to the first receiver's craft and use its time.
            witnesses.front().handed_in = {
                attempt, all_handed_in_series(run, tables.front().facts.first_epoch)};
            std::vector<ScreenedTable> screened = screen_receivers(tables, config, witnesses);
            for (std::size_t i = 0; i < screened.size(); ++i) {
                // Each table depends on the data of all receivers.
                screened[i].header = run.header();
                run.write(products::screened, attempt.receivers[i], write_screened(screened[i]));
                const ScreeningSummary summary = summarise(screened[i].rows);
                run.say(fmt::format("{} of {} epochs usable, in {} {}", summary.usable,
                                    screened[i].rows.size(), summary.arcs,
                                    summary.arcs == 1 ? "arc" : "arcs"));
                if (const auto& surface = screened[i].basis.surface)
                    run.say(fmt::format(
                        "Surface: {} of {} heights rejected; median {} m, scatter "
                        "{} m",
                        surface->rejected, surface->compared, format_fixed(surface->offset_m, 3),
                        format_fixed(surface->scatter_m, 3)));
                if (phases[i]) write_phases(run, attempt.receivers[i], *phases[i]);
            }
        });
}
