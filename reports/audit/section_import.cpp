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
        return step ? quantity_text(*step) + " " + unit : std::string("unknown");
    };
    return fmt::format("{} in position, {} in time", part(facts.position_resolution_m, "m"),
                       part(facts.time_resolution_s, "s"));
}

std::int64_t positions_of(const std::vector<Observation>& rows) {
    return std::ranges::count_if(rows, [](const Observation& row) {
        return row.latitude_deg.has_value() || row.plane_east_m.has_value();
    });
}

Facts facts_of(const Receiver& receiver, const Observations& observations) {
    const std::int64_t epochs = std::ssize(observations.rows);
    const std::int64_t positions = positions_of(observations.rows);
    return {{{"Format", format_text(receiver, observations)},
             {"Device",
              observations.device.empty() ? "the recording does not say" : observations.device},
             {"Coordinates", frame_words(observations.frame)},
             {"Time scale", scale_words(observations)},
             {"Time stamps", clock_words(observations)},
             {"Epochs", fmt::format("{}, {} with a position, mostly {} s apart", counted(epochs),
                                    counted(positions),
                                    format_fixed(observations.facts.nominal_interval_s, 3))},
             {"Heights", observations.facts.vertical_measured ? "measured" : "not measured"},
             {"Accuracy", accuracy_words(observations.accuracy_source)},
             {"Fix type", std::string(words_of(observations.solution_source))},
             {"Smallest steps", resolution_text(observations.facts)},
             {"Records", fmt::format("{} read, {} could not be read",
                                     counted(observations.records.total - observations.records.bad),
                                     counted(observations.records.bad))}}};
}

/// What the attempt says of the receiver that changes how its recording is read.
Facts declared(const Receiver& receiver) {
    Facts facts;
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) facts.add(name, value);
    };
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
        add("Accuracy, by the attempt", stated);
    }
    if (receiver.lever_arm)
        add("Lever arm, by the attempt", fmt::format("{} m forward, {} m right, {} m down",
                                                     quantity_text((*receiver.lever_arm)[0]),
                                                     quantity_text((*receiver.lever_arm)[1]),
                                                     quantity_text((*receiver.lever_arm)[2])));
    if (receiver.calibration)
        add("Calibration, by the attempt", calibration_text(*receiver.calibration));
    add("Antenna height, by the attempt", metres(receiver.antenna_height_m));
    add("Height, by the attempt", metres(receiver.height_m));
    add("Start date, by the attempt", receiver.start_date);
    if (receiver.start_gps) add("Start, by the attempt", to_utc_iso(*receiver.start_gps));
    if (receiver.utc_offset_h)
        add("Offset to UTC, by the attempt", quantity_text(*receiver.utc_offset_h) + " h");
    return facts;
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

std::vector<Block> left_out_blocks(const RecordCount& records, bool all) {
    if (records.bad == 0) return {Paragraph{"Records left out. None: every one could be read."}};
    constexpr std::ptrdiff_t shown_at_most = 20;
    Entries entries;
    for (const BadRecord& bad : records.bad_records) {
        if (!all && std::ssize(entries.items) == shown_at_most) break;
        entries.items.push_back(bad_record_text(bad));
    }
    std::string heading = fmt::format("Records left out. {} of {} could not be read",
                                      counted(records.bad), counted(records.total));
    if (std::ssize(entries.items) < records.bad)
        heading += fmt::format("; the first {}{}", counted(std::ssize(entries.items)),
                               std::ssize(entries.items) < std::ssize(records.bad_records)
                                   ? " (--all lists more)"
                                   : ", which is all that the table holds");
    return {Paragraph{heading + ":"}, std::move(entries)};
}

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
        facts.add("Another place, from", place_text(place));
    return facts;
}

Entries ephemerides_of(const PhaseTable& phase) {
    Entries entries;
    for (const UsedEphemeris& each : phase.ephemerides)
        entries.items.push_back(fmt::format("{}, issue {}, of {}, at {}{}", each.satellite,
                                            each.issue, each.reference_gps, each.place,
                                            each.healthy ? "" : "; the satellite is not healthy"));
    return entries;
}

/// The part about the raw phases of a receiver that has some.
std::vector<Section> imported_phases(const RunRecord& record, const ReceiverRecord& one, bool all) {
    if (!one.phase) return {};
    const PhaseTable& phase = *one.phase;
    Section section =
        product_section(record, "Raw phases", phase.header, one.phase_file,
                        fmt::format("{}, {}", phase.format, counted(phase.epochs, "epoch")), all);
    if (!phase.notes.empty()) section.add(Entries{.items = phase.notes});
    section.add(Paragraph{fmt::format(
        "Satellites' places are computed from {} (line or byte of the navigation at the end).",
        phase.ephemerides.size() == 1
            ? "one broadcast ephemeris"
            : counted(std::ssize(phase.ephemerides)) + " broadcast ephemerides")});
    if (all) section.add(ephemerides_of(phase));
    return {std::move(section)};
}

}  // namespace

Section import_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("import", one.receiver.id);
    if (!one.observations) return missing_section(title, one.observations_file);
    const Observations& observations = *one.observations;
    Section section = product_section(record, title, observations.header, one.observations_file,
                                      counted(std::ssize(observations.rows), "epoch"), all);
    section.add(facts_of(one.receiver, observations));
    if (Facts facts = declared(one.receiver); !facts.facts.empty()) section.add(std::move(facts));
    section.add(left_out_blocks(observations.records, all));
    if (!observations.notes.empty()) {
        section.add(Paragraph{"Noticed while reading:"});
        section.add(Entries{.items = observations.notes});
    }
    section.add(parameter_blocks(record.attempt, observations.header, all));
    section.parts = imported_phases(record, one, all);
    return section;
}

Section enu_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("enu", one.receiver.id);
    if (!one.enu) return missing_section(title, one.enu_file);
    const EnuTable& table = *one.enu;
    const auto positions = std::ranges::count_if(
        table.rows, [](const EnuEpoch& row) { return row.east_m.has_value(); });
    Section section =
        product_section(record, title, table.header, one.enu_file,
                        fmt::format("{}, {} with a position",
                                    counted(std::ssize(table.rows), "epoch"), counted(positions)),
                        all);
    section.add(frame_facts(table));
    section.add(parameter_blocks(record.attempt, table.header, all));
    return section;
}

}  // namespace runcert
