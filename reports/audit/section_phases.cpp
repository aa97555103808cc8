#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/sections.h"
#include "reports/words/phases.h"

namespace runcert {
namespace {

constexpr std::size_t slips_shown = 40;

std::string place_of(const SlipRecord& slip) {
    if (slip.line) return fmt::format("line {}", *slip.line);
    if (slip.byte) return fmt::format("byte {}", *slip.byte);
    return "";
}

FactTable slip_table(const ReceiverRecord& one, std::size_t count) {
    FactTable table;
    table.caption = "Slips, and what else ended arcs by a test";
    table.heads = {"Epoch", "Time", "Signal", "What was found", "In the raw file"};
    for (std::size_t i = 0; i < count; ++i) {
        const ScreenedPhase& row = one.slips[i].row;
        table.rows.push_back({fmt::format("{}", row.epoch),
                              format_fixed(row.time.seconds(), 3) + " s",
                              to_text(row.satellite) + " " + to_text(row.signal),
                              slip_evidence(row), place_of(one.slips[i])});
    }
    return table;
}

Entries ephemerides_of(const PhaseTable& phase) {
    Entries entries;
    for (const UsedEphemeris& each : phase.ephemerides)
        entries.items.push_back(fmt::format("{}, issue {}, of {}, at {}{}", each.satellite,
                                            each.issue, each.reference_gps, each.place,
                                            each.healthy ? "" : "; the satellite is not healthy"));
    return entries;
}

}  // namespace

std::vector<Section> imported_phases(const RunRecord& record, const ReceiverRecord& one, bool all) {
    if (!one.phase) return {};
    const PhaseTable& phase = *one.phase;
    Section section{.title = "Raw phases",
                    .blocks = file_blocks(
                        record, phase.header, one.phase_file,
                        fmt::format("{}, {}", phase.format, counted(phase.epochs, "epoch")), all)};
    if (!phase.notes.empty()) section.blocks.emplace_back(Entries{.items = phase.notes});
    section.blocks.emplace_back(Paragraph{fmt::format(
        "Satellites' places are computed from {} (line or byte of the navigation at the end).",
        phase.ephemerides.size() == 1
            ? "one broadcast ephemeris"
            : counted(std::ssize(phase.ephemerides)) + " broadcast ephemerides")});
    if (all) section.blocks.emplace_back(ephemerides_of(phase));
    return {std::move(section)};
}

std::vector<Section> screened_phases(const RunRecord& record, const ReceiverRecord& one, bool all) {
    if (!one.screened_phase) return {};
    const ScreenedPhaseTable& phases = *one.screened_phase;
    Section section{
        .title = "Carrier phases",
        .blocks = file_blocks(record, phases.header, one.screened_phase_file,
                              fmt::format("{} with phases", counted(phases.epochs, "epoch")), all)};
    section.blocks.emplace_back(Entries{.items = phase_sentences(phases)});
    const std::size_t count = all ? one.slips.size() : std::min(one.slips.size(), slips_shown);
    if (count > 0) section.blocks.emplace_back(slip_table(one, count));
    if (count < one.slips.size())
        section.blocks.emplace_back(
            Paragraph{fmt::format("{} more are shown with --all.", one.slips.size() - count)});
    Entries refused;
    for (const RefusedPair& pair : phases.refused_pairs) {
        if (!all && refused.items.size() >= slips_shown) break;
        refused.items.push_back(fmt::format("epoch {}, {} s: {} ({})", pair.epoch,
                                            format_fixed(pair.time_s, 3), words_of(pair.reason),
                                            counted(pair.satellites, "satellite")));
    }
    if (!refused.items.empty()) {
        section.blocks.emplace_back(Paragraph{"Pairs of epochs that could not be judged:"});
        section.blocks.emplace_back(std::move(refused));
    }
    return {std::move(section)};
}

}  // namespace runcert
