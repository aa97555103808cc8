#include "stages/import/import.h"

#include <fmt/format.h>

#include <array>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/csv.h"
#include "stages/import/rtklib_pos.h"

namespace runcert {
namespace {

constexpr std::string_view formats_read =
    "RTKLIB solutions (.pos), and tables (CSV) whose columns the attempt names";

/// A format that is known and not read, by how one of its first lines begins.
struct OtherFormat {
    std::string_view begin;
    std::string_view name;
};

constexpr std::array<OtherFormat, 10> other_formats{{{"$G", "NMEA 0183"},
                                                     {"$PFLA", "NMEA 0183"},
                                                     {"$B", "NMEA 0183"},
                                                     {"$FLYS", "FlySight 2"},
                                                     {"[header]", "Racelogic VBO"},
                                                     {"File created on", "Racelogic VBO"},
                                                     {"<?xml", "XML (GPX, KML)"},
                                                     {"<gpx", "GPX"},
                                                     {"<html", "a web page"},
                                                     {"%PDF", "PDF"}}};

std::string_view name_other_format(std::string_view bytes) {
    if (bytes.substr(0, 81).find("RINEX VERSION") != std::string_view::npos) return "RINEX";
    LineReader lines(bytes);
    while (const auto line = lines.next()) {
        if (line->number > 5) break;
        for (const OtherFormat& other : other_formats)
            if (line->text.starts_with(other.begin)) return other.name;
    }
    return {};
}

[[noreturn]] void refuse_unknown(const RecordingBytes& recording) {
    const std::string where = place_in(recording, 1, 1);
    if (csv::recognises(recording.bytes))
        throw Failure(where, "the recording looks like a table, and the attempt names no columns",
                      "Write columns: {time: ..., latitude: ..., ...} and frame: in the receiver");
    const std::string_view name = name_other_format(recording.bytes);
    const std::string first =
        escape_for_message(LineReader(recording.bytes).next().value_or(SourceLine{}).text);
    throw Failure(
        where,
        name.empty()
            ? fmt::format("the format of the recording is not recognised; it begins \"{}\"", first)
            : fmt::format("the recording is {}, which is not read", name),
        fmt::format("Formats that are read: {}", formats_read));
}

/// What holds of every format's result.
void check(const Observations& observations) {
    if (observations.rows.empty() || observations.format.empty())
        throw Failure("stages/import", "a format gave an unfinished result",
                      "This is a fault of the program; please report it");
}

Observations read_by_format(const Receiver& receiver, const RecordingBytes& recording) {
    if (receiver.format == "rtklib-pos") return rtklib_pos::read(receiver, recording);
    if (receiver.format == "csv") return csv::read(receiver, recording);
    if (!receiver.format.empty() && receiver.format != "auto")
        throw Failure(
            receiver.place.empty() ? "receiver " + receiver.id : receiver.place,
            fmt::format("the format \"{}\" is not read", escape_for_message(receiver.format)),
            fmt::format("Formats that are read: {}", formats_read));
    require_text(recording);
    if (!receiver.columns.empty()) return csv::read(receiver, recording);
    if (rtklib_pos::recognises(recording.bytes)) return rtklib_pos::read(receiver, recording);
    refuse_unknown(recording);
}

}  // namespace

Observations import_recording(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = read_by_format(receiver, recording);
    check(observations);
    return observations;
}

}  // namespace runcert
