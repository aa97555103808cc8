#include <fmt/format.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/screening.h"
#include "reports/audit/sections.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

constexpr std::size_t slips_shown = 40;

std::string place_of(const SlipRecord& slip) {
    if (slip.line) return fmt::format("line {}", *slip.line);
    if (slip.byte) return fmt::format("byte {}", *slip.byte);
    return "";
}

Block slip_table(const ReceiverResults& one, std::size_t count) {
    Block slips = table({">Epoch", ">Time", "Signal", "What was found", "In the raw file"},
                        "Slips, and what else ended arcs by a test");
    for (std::size_t i = 0; i < count; ++i) {
        const ScreenedPhase& row = one.slips[i].row;
        add_row(slips, {fmt::format("{}", row.epoch), format_fixed(row.time.seconds(), 3) + " s",
                        to_text(row.satellite) + " " + to_text(row.signal), slip_evidence(row),
                        place_of(one.slips[i])});
    }
    return slips;
}

/// The part about the carrier phases of a receiver that has some.
std::vector<Block> screened_phases(const RunRecord& record, const ReceiverResults& one, bool all) {
    if (!one.screened_phase) return {};
    const ScreenedPhaseTable& phases = *one.screened_phase;
    std::vector<Block> blocks{heading("Carrier phases")};
    add(blocks,
        product_blocks(record, phases.header, one.files.at("screened_phase"),
                       fmt::format("{} with phases", counted(phases.epochs, "epoch")), all));
    blocks.push_back(list_of(phase_sentences(phases)));
    const std::size_t count = all ? one.slips.size() : std::min(one.slips.size(), slips_shown);
    if (count > 0) blocks.push_back(slip_table(one, count));
    if (count < one.slips.size())
        blocks.push_back(
            paragraph(fmt::format("{} more are shown with --all.", one.slips.size() - count)));
    std::vector<std::string> refused;
    for (const RefusedPair& pair : phases.refused_pairs) {
        if (!all && refused.size() >= slips_shown) break;
        refused.push_back(fmt::format("epoch {}, {} s: {} ({})", pair.epoch,
                                      format_fixed(pair.time_s, 3), words_of(pair.reason),
                                      counted(pair.satellites, "satellite")));
    }
    if (!refused.empty())
        blocks.push_back(
            titled_list("Pairs of epochs that could not be judged", std::move(refused)));
    return blocks;
}

/// What the audit of screening is about beside its table.
AuditSubject subject_of(const RunRecord& record, const ReceiverResults& one) {
    AuditSubject subject{.recording = claimed_value(recording_names(one.receiver))};
    if (!is_there(one.windows.header)) return subject;
    for (const ProfileWindows& windows : one.windows.profiles)
        if (const auto rule = rule_view(record, windows.profile, &windows); rule && rule->best())
            subject.windows.push_back({.profile = windows.profile,
                                       .duration_s = windows.best->span.duration.seconds(),
                                       .unit = rule->unit()});
    return subject;
}

}  // namespace

std::vector<Block> screen_blocks(const RunRecord& record, const ReceiverResults& one, bool all) {
    const ScreeningSummary summary = summarise(one.screened.rows);
    std::vector<Block> blocks = product_blocks(
        record, one.screened.header, one.files.at("screened"),
        fmt::format("{}, {} of them used", counted(std::ssize(one.screened.rows), "epoch"),
                    counted(summary.usable)),
        all);
    add(blocks, parameter_blocks(record.attempt, {&one.screened.header},
                                 all ? Level::record : Level::annex));
    add(blocks, screening_blocks(one.screened, subject_of(record, one), all));
    add(blocks, screened_phases(record, one, all));
    return blocks;
}

}  // namespace runcert
