#include <fmt/format.h>

#include <algorithm>

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

/// The part about the carrier phases of a receiver that has some.
std::vector<Section> screened_phases(const RunRecord& record, const ReceiverRecord& one, bool all) {
    if (!one.screened_phase) return {};
    const ScreenedPhaseTable& phases = *one.screened_phase;
    Section section =
        product_section(record, "Carrier phases", phases.header, one.screened_phase_file,
                        fmt::format("{} with phases", counted(phases.epochs, "epoch")), all);
    section.add(Entries{.items = phase_sentences(phases)});
    const std::size_t count = all ? one.slips.size() : std::min(one.slips.size(), slips_shown);
    if (count > 0) section.add(slip_table(one, count));
    if (count < one.slips.size())
        section.add(
            Paragraph{fmt::format("{} more are shown with --all.", one.slips.size() - count)});
    Entries refused;
    for (const RefusedPair& pair : phases.refused_pairs) {
        if (!all && refused.items.size() >= slips_shown) break;
        refused.items.push_back(fmt::format("epoch {}, {} s: {} ({})", pair.epoch,
                                            format_fixed(pair.time_s, 3), words_of(pair.reason),
                                            counted(pair.satellites, "satellite")));
    }
    if (!refused.items.empty()) {
        section.add(Paragraph{"Pairs of epochs that could not be judged:"});
        section.add(std::move(refused));
    }
    return {std::move(section)};
}

}  // namespace

Section screen_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("screen", one.receiver.id);
    if (!one.screened) return missing_section(title, one.screened_file);
    AuditSubject subject{.attempt = record.attempt.id, .recording = one.recording};
    for (const std::string& file : one.witnesses) {
        const auto named = record.named_by.find(file);
        const bool checked = record.files.contains(file) && named != record.named_by.end();
        (checked ? subject.checked : subject.unchecked).push_back(file);
    }
    if (one.windows)
        for (const ProfileWindows& windows : one.windows->profiles)
            if (windows.best)
                subject.windows.push_back({.profile = windows.profile,
                                           .duration_s = windows.best->span.duration.seconds()});
    Section screening = screening_section(*one.screened, subject, all);
    const ScreeningSummary summary = summarise(one.screened->rows);
    Section section = product_section(
        record, title, one.screened->header, one.screened_file,
        fmt::format("{}, {} of them used", counted(std::ssize(one.screened->rows), "epoch"),
                    counted(summary.usable)),
        all);
    section.add(parameter_blocks(record.attempt, one.screened->header, all));
    std::vector<Section> parts = std::move(screening.parts);
    section.parts.push_back(std::move(screening));
    section.add_parts(std::move(parts));
    section.add_parts(screened_phases(record, one, all));
    return section;
}

}  // namespace runcert
