#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/sections.h"

namespace runcert {
namespace {

std::int64_t positions_of(const std::vector<Observation>& rows) {
    return std::ranges::count_if(rows, [](const Observation& row) {
        return row.latitude_deg.has_value() || row.plane_east_m.has_value();
    });
}

std::string bad_record_text(const BadRecord& bad) {
    std::string place = bad.file ? fmt::format("file {}, ", *bad.file) : "";
    place += bad.line ? fmt::format("line {}", *bad.line) : fmt::format("byte {}", bad.byte);
    if (bad.column) place += fmt::format(", byte {} of it", *bad.column);
    return fmt::format(
        "{} ({}): {}", place,
        bad.epoch == 0 ? "before the first epoch" : fmt::format("at epoch {}", bad.epoch),
        bad.what);
}

Block left_out_block(const RecordCount& records, Level level) {
    if (records.bad == 0) return paragraph("Records left out. None: every one could be read.");
    constexpr std::ptrdiff_t shown_at_most = 20;
    std::vector<std::string> bad_ones;
    for (const BadRecord& bad : records.bad_records) {
        if (level != Level::all && std::ssize(bad_ones) == shown_at_most) break;
        bad_ones.push_back(bad_record_text(bad));
    }
    std::string title = fmt::format("Records left out. {} of {} could not be read",
                                    counted(records.bad), counted(records.total));
    if (std::ssize(bad_ones) < records.bad)
        title += fmt::format("; the first {}{}", counted(std::ssize(bad_ones)),
                             std::ssize(bad_ones) < std::ssize(records.bad_records)
                                 ? " (--all lists more)"
                                 : ", which is all that the table holds");
    return titled_list(std::move(title), std::move(bad_ones));
}

std::vector<std::string> ephemerides_of(const PhaseTable& phase) {
    std::vector<std::string> used;
    for (const UsedEphemeris& each : phase.ephemerides)
        used.push_back(fmt::format("{}, issue {}, of {}, at {}{}", each.satellite, each.issue,
                                   each.reference_gps, each.place,
                                   each.healthy ? "" : "; the satellite is not healthy"));
    return used;
}

}  // namespace

ProductPart phase_part(const RunRecord& /*record*/, const ReceiverResults& one, Level level) {
    const PhaseTable& phase = *one.phase;
    std::vector<Block> blocks;
    if (!phase.notes.empty()) blocks.push_back(list_of(phase.notes));
    blocks.push_back(paragraph(fmt::format(
        "Satellites' places are computed from {} (line or byte of the navigation at the end).",
        phase.ephemerides.size() == 1
            ? "one broadcast ephemeris"
            : counted(std::ssize(phase.ephemerides)) + " broadcast ephemerides")));
    if (level == Level::all) blocks.push_back(list_of(ephemerides_of(phase)));
    return {fmt::format("{}, {}", phase.format, counted(phase.epochs, "epoch")), std::move(blocks)};
}

ProductPart imu_part(const RunRecord& /*record*/, const ReceiverResults& one, Level level) {
    const ImuTable& imu = *one.imu;
    Block found = facts(
        {{"Axes x, y, z", fmt::format("{}", fmt::join(imu.axes, ", "))},
         {"Rate", fmt::format("{} Hz; stamps jitter by {} ms", format_fixed(imu.clock.rate_hz, 3),
                              format_fixed(imu.clock.jitter_s * 1e3, 2))},
         {"Gaps", counted(imu.found.gaps)}});
    if (imu.rest)
        add_fact(found, "Quietest second",
                 fmt::format("{} m/s2, the down axis {} degrees from gravity",
                             format_fixed(imu.rest->specific_force_m_s2, 3),
                             format_fixed(imu.rest->down_deg, 1)));
    std::vector<Block> blocks{std::move(found)};
    if (!imu.notes.empty()) blocks.push_back(list_of(imu.notes));
    blocks.push_back(left_out_block(imu.records, level));
    return {fmt::format("{}, {}", imu.format, counted(imu.records.total, "sample")),
            std::move(blocks)};
}

ProductPart surface_part(const RunRecord& /*record*/, const ReceiverResults& one, Level /*level*/) {
    const SurfaceTable& surface = *one.surface;
    Block found = facts({});
    add_fact(found, "Source", surface.source);
    add_fact(found, "Vertices",
             fmt::format("{}, median edge {} m", surface.found.vertices,
                         format_fixed(surface.found.edge_m, 1)));
    add_fact(found, "Height of a vertex, standard deviation",
             format_fixed(surface.vertical_sd_m, 3) + " m");
    if (surface.undulation_m != 0.0)
        add_fact(found, "Undulation added", format_fixed(surface.undulation_m, 3) + " m");
    for (const SurfaceRun& run : surface.made_from)
        add_fact(found, "Made from",
                 fmt::format("run {}, {}", run.id, counted(run.positions, "position")));
    std::vector<Block> blocks{std::move(found)};
    if (!surface.notes.empty()) blocks.push_back(list_of(surface.notes));
    return {fmt::format("{}, {}", surface.format, counted(surface.found.triangles, "triangle")),
            std::move(blocks)};
}

ProductPart observations_part(const RunRecord& record, const ReceiverResults& one, Level level) {
    const Observations& observations = one.observations;
    const auto& rows = observations.rows;
    Block recorded = recording_facts(observations, one.receiver, std::ssize(rows),
                                     rows.empty() ? ElapsedTime{} : rows.back().time);
    add_fact(recorded, "With a position", counted(positions_of(rows), "epoch"));
    std::vector<Block> blocks{std::move(recorded), left_out_block(observations.records, level)};
    add(blocks, parameter_blocks(record.attempt, {&observations.header}, level));
    return {counted(std::ssize(rows), "epoch"), std::move(blocks)};
}

ProductPart enu_part(const RunRecord& record, const ReceiverResults& one, Level level) {
    const EnuTable& table = one.enu;
    const auto positions = std::ranges::count_if(
        table.rows, [](const EnuEpoch& row) { return row.east_m.has_value(); });
    std::vector<Block> blocks{frame_facts(table.origin)};
    add(blocks, parameter_blocks(record.attempt, {&table.header}, level));
    return {fmt::format("{}, {} with a position", counted(std::ssize(table.rows), "epoch"),
                        counted(positions)),
            std::move(blocks)};
}

}  // namespace runcert
