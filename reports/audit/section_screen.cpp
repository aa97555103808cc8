#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
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

/// "0.98 ± 0.04 cycles; square sum of the weighted residuals 571.8, at most 22.5; Doppler 0.99
/// cycles".
std::string slip_evidence(const ScreenedPhase& row) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
    if (row.cycles)
        add(fmt::format("{} ± {} cycles", format_fixed(*row.cycles, 2),
                        format_fixed(row.sigma_cycles.value_or(0.0), 2)));
    if (row.begins == ArcStart::geometry_free)
        add(fmt::format("its bands parted by {} m, at most {} m",
                        format_fixed(row.statistic.value_or(0.0), 3),
                        format_fixed(row.threshold.value_or(0.0), 3)));
    else
        add(fmt::format("square sum of the weighted residuals {}, at most {}",
                        format_fixed(row.statistic.value_or(0.0), 1),
                        format_fixed(row.threshold.value_or(0.0), 1)));
    if (row.wide_lane_cycles)
        add(fmt::format("wide lane {} cycles", format_fixed(*row.wide_lane_cycles, 2)));
    if (row.beyond_doppler_cycles)
        add(fmt::format("beyond Doppler {} cycles", format_fixed(*row.beyond_doppler_cycles, 2)));
    if (row.begins != ArcStart::geometry_free && row.begins != ArcStart::displacement)
        add("repaired");
    return text;
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

}  // namespace

ProductPart screened_phase_part(const RunRecord& /*record*/, const ReceiverResults& one,
                                Level level) {
    const ScreenedPhaseTable& phases = *one.screened_phase;
    std::vector<Block> blocks{list_of(phase_sentences(phases))};
    const std::size_t count =
        level == Level::all ? one.slips.size() : std::min(one.slips.size(), slips_shown);
    if (count > 0) blocks.push_back(slip_table(one, count));
    if (count < one.slips.size())
        blocks.push_back(
            paragraph(fmt::format("{} more are shown with --all.", one.slips.size() - count)));
    std::vector<std::string> refused;
    for (const RefusedPair& pair : phases.refused_pairs) {
        if (level != Level::all && refused.size() >= slips_shown) break;
        refused.push_back(fmt::format("epoch {}, {} s: {} ({})", pair.epoch,
                                      format_fixed(pair.time_s, 3), words_of(pair.reason),
                                      counted(pair.satellites, "satellite")));
    }
    if (!refused.empty())
        blocks.push_back(
            titled_list("Pairs of epochs that could not be judged", std::move(refused)));
    return {fmt::format("{} with phases", counted(phases.epochs, "epoch")), std::move(blocks)};
}

ProductPart screened_part(const RunRecord& record, const ReceiverResults& one, Level level) {
    std::vector<Block> blocks = parameter_blocks(record.attempt, {&one.screened.header}, level);
    add(blocks, screening_blocks(one.screened, level));
    return {fmt::format("{}, {} of them used", counted(std::ssize(one.screened.rows), "epoch"),
                        counted(summarise(one.screened.rows).usable)),
            std::move(blocks)};
}

}  // namespace runcert
