#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/screening.h"
#include "reports/audit/sections.h"
#include "reports/words/estimation.h"

namespace runcert {
namespace {

Facts frame_facts(const EnuTable& table) {
    if (!table.origin) return {{{"Frame", engineering_crs_text()}}};
    const Geodetic& at = table.origin->position;
    Facts facts{
        {{"Frame", "east, north and up at the origin, on WGS 84, without the scale of a map"},
         {"Origin",
          fmt::format("latitude {}, longitude {}, height {} m",
                      format_fixed(at.latitude.degrees(), 9),
                      format_fixed(at.longitude.degrees(), 9), format_fixed(at.height_m, 3))},
         {"Chosen by", table.origin->source == "attempt"
                           ? "the attempt"
                           : "the program: it is the first position of the recording"}}};
    for (const FramePlace& place : table.origin->places)
        facts.facts.push_back({"Another place, from", place_text(place)});
    return facts;
}

}  // namespace

Section enu_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("enu", one.receiver.id);
    if (!one.enu) return missing_section(title, one.enu_file);
    const EnuTable& table = *one.enu;
    const auto positions = std::ranges::count_if(
        table.rows, [](const EnuEpoch& row) { return row.east_m.has_value(); });
    Section section{.title = title,
                    .blocks = file_blocks(
                        record, table.header, one.enu_file,
                        fmt::format("{}, {} with a position",
                                    counted(std::ssize(table.rows), "epoch"), counted(positions)),
                        all)};
    section.blocks.emplace_back(frame_facts(table));
    for (Block& block : parameter_blocks(record.attempt, table.header, all))
        section.blocks.push_back(std::move(block));
    return section;
}

Section screen_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("screen", one.receiver.id);
    if (!one.screened) return missing_section(title, one.screened_file);
    AuditSubject subject{
        .attempt = record.attempt.id, .recording = one.recording, .checked = {}, .unchecked = {}};
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
    Section section{
        .title = title,
        .blocks = file_blocks(
            record, one.screened->header, one.screened_file,
            fmt::format("{}, {} of them used", counted(std::ssize(one.screened->rows), "epoch"),
                        counted(summary.usable)),
            all)};
    for (Block& block : parameter_blocks(record.attempt, one.screened->header, all))
        section.blocks.push_back(std::move(block));
    section.parts.push_back(
        {.title = std::move(screening.title), .blocks = std::move(screening.blocks)});
    for (Section& part : screening.parts)
        section.parts.push_back(std::move(part));
    for (Section& part : screened_phases(record, one, all))
        section.parts.push_back(std::move(part));
    return section;
}

}  // namespace runcert
