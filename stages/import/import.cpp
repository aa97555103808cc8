#include "stages/import/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/csv/csv.h"
#include "stages/import/flysight/flysight.h"
#include "stages/import/gpx/gpx.h"
#include "stages/import/igc/igc.h"
#include "stages/import/join.h"
#include "stages/import/nmea/nmea.h"
#include "stages/import/oao/oao.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/rtklib_pos/rtklib_pos.h"
#include "stages/import/sbn/sbn.h"
#include "stages/import/sbp/sbp.h"
#include "stages/import/ubx/ubx.h"
#include "stages/import/vbo/vbo.h"

namespace runcert {
namespace {

/// Recordings of up to so many bytes are held: reading twice would take them longer.
constexpr std::size_t held_whole_bytes = std::size_t{64} << 20;

/// A format that is recognised by its content.
struct Format {
    std::string_view name;  ///< as the attempt's `format` has it
    std::string_view what;  ///< in words
    bool (*recognises)(std::string_view bytes);
    Observations (*read)(const Receiver&, const RecordingBytes&);
};

/// In the order in which they are tried: those that no other could be taken for come first.
constexpr std::array formats{
    Format{"rtklib-pos", "RTKLIB solution, .pos", rtklib_pos::recognises, rtklib_pos::read},
    Format{"oao", "Motion OAO", oao::recognises, oao::read},
    Format{"sbp", "Locosys SBP", sbp::recognises, sbp::read},
    Format{"sbn", "Locosys SBN", sbn::recognises, sbn::read},
    Format{"ubx", "u-blox UBX", ubx::recognises, ubx::read},
    Format{"vbo", "Racelogic VBO", vbo::recognises, vbo::read},
    Format{"flysight", "FlySight", flysight::recognises, flysight::read},
    Format{"gpx", "GPX", gpx::recognises, gpx::read},
    Format{"igc", "IGC", igc::recognises, igc::read},
    Format{"nmea", "NMEA 0183", nmea::recognises, nmea::read},
};

/// "RTKLIB solution (.pos) rtklib-pos, ...".
std::string formats_read() {
    std::string text;
    for (const Format& format : formats)
        text += fmt::format("{} ({}), ", format.what, format.name);
    return text +
           "RINEX with base and navigation files (rinex), tables whose columns the attempt "
           "names (csv), and what gpsbabel reads (gpsbabel)";
}

/// A format that is known and not read, by how one of its first lines begins.
struct OtherFormat {
    std::string_view begin;
    std::string_view name;
};

constexpr std::array<OtherFormat, 4> other_formats{
    {{"<?xml", "XML"}, {"<html", "a web page"}, {"<!DOCTYPE html", "a web page"}, {"%PDF", "PDF"}}};

std::string_view name_other_format(std::string_view bytes) {
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
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    if (rinex::recognises(head))
        throw Failure(where, "the recording is RINEX, raw observations and not positions",
                      "Give the base station's observations and the navigation file in the "
                      "attempt: base: ..., navigation: ...");
    require_text(recording);
    if (csv::recognises(head))
        throw Failure(where, "the recording looks like a table, and the attempt names no columns",
                      "Write columns: {time: ..., latitude: ..., ...} and frame: in the receiver");
    const std::string_view name = name_other_format(head);
    const std::string first =
        escape_for_message(LineReader(head).next().value_or(SourceLine{}).text);
    throw Failure(
        where,
        name.empty()
            ? fmt::format("the format of the recording is not recognised; it begins \"{}\"", first)
            : fmt::format("the recording is {}, which is not read", name),
        fmt::format("Formats that are read: {}", formats_read()));
}

/// What holds of every format's result.
void check(const Observations& observations) {
    if (observations.rows.empty() || observations.format.empty())
        throw Failure("stages/import", "a format gave an unfinished result",
                      "This is a fault of the program; please report it");
}

Observations read_by_format(const Receiver& receiver, const RecordingBytes& recording) {
    require_readable(recording);
    const bool recognise = receiver.format.empty() || receiver.format == "auto";
    if (receiver.format == "csv" || (recognise && !receiver.columns.empty()))
        return csv::read(receiver, recording);
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    for (const Format& format : formats)
        if (recognise ? format.recognises(head) : receiver.format == format.name)
            return format.read(receiver, recording);
    if (recognise) refuse_unknown(recording);
    throw Failure(receiver.place.empty() ? "receiver " + receiver.id : receiver.place,
                  fmt::format("the format \"{}\" is not read", escape_for_message(receiver.format)),
                  fmt::format("Formats that are read: {}", formats_read()));
}

}  // namespace

bool is_read_by_itself(const Receiver& receiver, const RecordingBytes& recording) {
    if (!receiver.format.empty() && receiver.format != "auto") return true;
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    return !receiver.columns.empty() ||
           std::any_of(formats.begin(), formats.end(),
                       [&](const Format& format) { return format.recognises(head); });
}

Observations import_recording(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = read_by_format(receiver, recording);
    check(observations);
    return observations;
}

std::optional<RowByRow> import_row_by_row(const Receiver& receiver,
                                          const RecordingBytes& recording) {
    const bool recognise = receiver.format.empty() || receiver.format == "auto";
    const bool is_pos = recognise
                            ? receiver.columns.empty() &&
                                  rtklib_pos::recognises(recording.bytes.substr(0, recognised_by))
                            : receiver.format == "rtklib-pos";
    if (!is_pos || recording.bytes.size() <= held_whole_bytes) return std::nullopt;
    require_readable(recording);
    return rtklib_pos::read_row_by_row(receiver, recording);
}

Observations import_recordings(const Receiver& receiver,
                               const std::vector<RecordingBytes>& recordings,
                               const std::function<ReadRecording>& read_one) {
    require_joinable(recordings);
    std::vector<Observations> parts;
    for (const RecordingBytes& recording : recordings)
        parts.push_back(read_one(receiver, recording));
    return join(std::move(parts), recordings);
}

}  // namespace runcert
