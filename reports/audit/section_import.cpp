#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/sections.h"
#include "reports/words/attempt.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

/// How the format was known, and what exactly it is.
std::string format_text(const Receiver& receiver, const Observations& observations) {
    return fmt::format("{}{}{}", observations.format,
                       observations.variant.empty() ? "" : " (" + observations.variant + ")",
                       receiver.format == "auto" ? ", recognised by the recording's content"
                                                 : ", because the attempt says so");
}

std::string frame_words(const std::string& frame) {
    return frame == "geodetic"      ? "latitude, longitude and height on WGS 84"
           : frame == "ecef"        ? "Earth-centred coordinates on WGS 84"
           : frame == "utm"         ? "UTM coordinates"
           : frame == "local_plane" ? "engineering coordinates of the recording"
                                    : frame;
}

std::string scale_words(const Observations& observations) {
    const std::string& scale = observations.time_scale;
    const std::string first =
        observations.facts.first_epoch
            ? "; the first epoch is at " + to_utc_iso(*observations.facts.first_epoch)
            : "; when the first epoch was is not known";
    return (scale == "gps"        ? "GPS time"
            : scale == "utc"      ? "UTC, taken to GPS time by the leap seconds of the day"
            : scale == "relative" ? "relative to a beginning that the recording does not state"
                                  : scale) +
           first;
}

std::string accuracy_words(const std::string& source) {
    return source == "recording" ? "as the recording states it, epoch by epoch"
           : source == "attempt" ? "as the attempt states it: the recording states none"
                                 : "not stated";
}

std::string clock_words(const Observations& observations) {
    const std::string& source = observations.facts.time_source;
    const std::string origin =
        observations.time_origin.empty() ? "" : observations.time_origin + ": ";
    return origin + (source == "satellites" ? "the satellites' time, as the format says"
                     : source == "attempt"  ? "the satellites' time, as the attempt states"
                                            : "whose clock made them is not known");
}

std::string resolution_text(const RecordingFacts& facts) {
    const auto part = [](const std::optional<double>& step, const char* unit) {
        return step ? fmt::format("{:.2g} {}", *step, unit) : std::string("unknown");
    };
    return fmt::format("{} in position, {} in time", part(facts.position_resolution_m, "m"),
                       part(facts.time_resolution_s, "s"));
}

std::int64_t positions_of(const std::vector<Observation>& rows) {
    return std::ranges::count_if(rows, [](const Observation& row) {
        return row.latitude_deg.has_value() || row.plane_east_m.has_value();
    });
}

Block recording_facts(const Receiver& receiver, const Observations& observations) {
    const std::int64_t epochs = std::ssize(observations.rows);
    const std::int64_t positions = positions_of(observations.rows);
    return facts(
        {{"Format", format_text(receiver, observations)},
         {"Device",
          observations.device.empty() ? "the recording does not say" : observations.device},
         {"Coordinates", frame_words(observations.frame)},
         {"Time scale", scale_words(observations)},
         {"Time stamps", clock_words(observations)},
         {"Epochs",
          fmt::format("{}, {} with a position, mostly {} s apart", counted(epochs),
                      counted(positions), format_fixed(observations.facts.nominal_interval_s, 3))},
         {"Heights", observations.facts.vertical_measured ? "measured" : "not measured"},
         {"Accuracy", accuracy_words(observations.accuracy_source)},
         {"Fix type", std::string(words_of(observations.solution_source))},
         {"Smallest steps", resolution_text(observations.facts)},
         {"Records", fmt::format("{} read, {} could not be read",
                                 counted(observations.records.total - observations.records.bad),
                                 counted(observations.records.bad))}});
}

/// What the attempt says of the receiver that changes how its recording is read.
Block declared(const Receiver& receiver) {
    Block told = facts({}, "By the attempt");
    const auto metres = [](const std::optional<double>& value) {
        return value ? quantity_text(*value) + " m" : std::string();
    };
    if (receiver.accuracy) {
        std::string stated;
        const auto append = [&](const std::string& figure, const char* of) {
            if (!figure.empty()) stated += (stated.empty() ? "" : ", ") + figure + of;
        };
        append(metres(receiver.accuracy->horizontal_m), " horizontal");
        append(metres(receiver.accuracy->vertical_m), " vertical");
        if (const auto& velocity_m_s = receiver.accuracy->velocity_m_s)
            append(quantity_text(*velocity_m_s) + " m/s", " of velocities");
        add_fact(told, "Accuracy", stated);
    }
    if (receiver.lever_arm)
        add_fact(told, "Lever arm",
                 fmt::format("{} m forward, {} m right, {} m down",
                             quantity_text((*receiver.lever_arm)[0]),
                             quantity_text((*receiver.lever_arm)[1]),
                             quantity_text((*receiver.lever_arm)[2])));
    if (receiver.calibration)
        add_fact(told, "Calibration", calibration_text(*receiver.calibration));
    add_fact(told, "Antenna height", metres(receiver.antenna_height_m));
    add_fact(told, "Height", metres(receiver.height_m));
    add_fact(told, "Start date", receiver.start_date);
    if (receiver.start_gps) add_fact(told, "Start", to_utc_iso(*receiver.start_gps));
    if (receiver.utc_offset_h)
        add_fact(told, "Offset to UTC", quantity_text(*receiver.utc_offset_h) + " h");
    return told;
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

Block left_out_block(const RecordCount& records, bool all) {
    if (records.bad == 0) return paragraph("Records left out. None: every one could be read.");
    constexpr std::ptrdiff_t shown_at_most = 20;
    std::vector<std::string> bad_ones;
    for (const BadRecord& bad : records.bad_records) {
        if (!all && std::ssize(bad_ones) == shown_at_most) break;
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

Block frame_facts(const EnuTable& table) {
    if (!table.origin) return facts({{"Frame", engineering_crs_text()}});
    const Geodetic& at = table.origin->position;
    Block told =
        facts({{"Frame", "east, north and up at the origin, on WGS 84, without the scale of a map"},
               {"Origin",
                fmt::format("latitude {}, longitude {}, height {} m",
                            format_fixed(at.latitude.degrees(), 9),
                            format_fixed(at.longitude.degrees(), 9), format_fixed(at.height_m, 3))},
               {"Chosen by", table.origin->source == "attempt"
                                 ? "the attempt"
                                 : "the program: it is the first position of the recording"}});
    for (const FramePlace& place : table.origin->places)
        add_fact(told, "Another place, from", place_text(place));
    return told;
}

std::vector<std::string> ephemerides_of(const PhaseTable& phase) {
    std::vector<std::string> used;
    for (const UsedEphemeris& each : phase.ephemerides)
        used.push_back(fmt::format("{}, issue {}, of {}, at {}{}", each.satellite, each.issue,
                                   each.reference_gps, each.place,
                                   each.healthy ? "" : "; the satellite is not healthy"));
    return used;
}

/// The part about the raw phases of a receiver that has some.
std::vector<Block> imported_phases(const RunRecord& record, const ReceiverRecord& one, bool all) {
    if (!one.phase) return {};
    const PhaseTable& phase = *one.phase;
    std::vector<Block> blocks{heading("Raw phases")};
    append(blocks, product_blocks(
                       record, phase.header, one.phase_file,
                       fmt::format("{}, {}", phase.format, counted(phase.epochs, "epoch")), all));
    if (!phase.notes.empty()) blocks.push_back(list_of(phase.notes));
    blocks.push_back(paragraph(fmt::format(
        "Satellites' places are computed from {} (line or byte of the navigation at the end).",
        phase.ephemerides.size() == 1
            ? "one broadcast ephemeris"
            : counted(std::ssize(phase.ephemerides)) + " broadcast ephemerides")));
    if (all) blocks.push_back(list_of(ephemerides_of(phase)));
    return blocks;
}

}  // namespace

std::vector<Block> import_blocks(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const Observations& observations = *one.observations;
    std::vector<Block> blocks =
        product_blocks(record, observations.header, one.observations_file,
                       counted(std::ssize(observations.rows), "epoch"), all);
    blocks.push_back(recording_facts(one.receiver, observations));
    if (Block told = declared(one.receiver); !told.facts.empty()) blocks.push_back(std::move(told));
    blocks.push_back(left_out_block(observations.records, all));
    if (!observations.notes.empty())
        blocks.push_back(titled_list("Noticed while reading", observations.notes));
    append(blocks, parameter_blocks(record.attempt, observations.header, all));
    append(blocks, imported_phases(record, one, all));
    return blocks;
}

std::vector<Block> enu_blocks(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const EnuTable& table = *one.enu;
    const auto positions = std::ranges::count_if(
        table.rows, [](const EnuEpoch& row) { return row.east_m.has_value(); });
    std::vector<Block> blocks =
        product_blocks(record, table.header, one.enu_file,
                       fmt::format("{}, {} with a position",
                                   counted(std::ssize(table.rows), "epoch"), counted(positions)),
                       all);
    blocks.push_back(frame_facts(table));
    append(blocks, parameter_blocks(record.attempt, table.header, all));
    return blocks;
}

}  // namespace runcert
