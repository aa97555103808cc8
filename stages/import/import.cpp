#include "stages/import/import.h"

#include <fmt/format.h>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/csv/csv.h"
#include "stages/import/format.h"
#include "stages/import/rinex/rinex.h"

namespace runcert {
namespace {

/// Recordings of up to so many bytes are held: reading twice would take them longer.
constexpr std::size_t held_whole_bytes = std::size_t{64} << 20;

/// "RTKLIB solution, .pos (rtklib-pos), ...".
std::string formats_read() {
    std::string text;
    for (const Format* format : formats())
        text += fmt::format("{}{} ({})",
                            text.empty()                 ? ""
                            : format == formats().back() ? ", and "
                                                         : ", ",
                            format->what, format->name);
    return text;
}

[[noreturn]] void refuse_unknown(const RecordingBytes& recording) {
    const std::string where = place_in(recording, 1, 1);
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    if (rinex::recognises(head))
        throw Failure(where, "the recording is RINEX, raw observations and not positions",
                      "Give the base station's observations and the navigation file in the "
                      "attempt (keys `base` and `navigation`)");
    refuse_not_read(recording, false);
    require_text(recording);
    if (csv::recognises(head))
        throw Failure(where, "the recording looks like a table, and the attempt names no columns",
                      "Write columns: {time: ..., latitude: ..., ...} and frame: in the receiver; "
                      "runcert inspect "
                      "proposes them");
    const std::string first =
        escape_for_message(LineReader(head).next().value_or(SourceLine{}).text);
    throw Failure(
        where,
        fmt::format("the format of the recording is not recognised; it begins \"{}\"", first),
        fmt::format("Formats that are read: {}", formats_read()));
}

/// What holds of every format's result.
void check(const Observations& observations) {
    if (observations.rows.empty() || observations.format.empty())
        throw Failure("stages/import", "a format gave an unfinished result",
                      "This is a fault of the program; please report it");
}

bool to_be_recognised(const Receiver& receiver) {
    return receiver.format.empty() || receiver.format == "auto";
}

/// The format of a recording: as the attempt says, or by its content. Null where it is unknown.
const Format* choose(const Receiver& receiver, const RecordingBytes& recording) {
    if (!to_be_recognised(receiver)) return find_format(receiver.format);
    if (!receiver.columns.empty()) return find_format("csv");
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    for (const Format* format : formats())
        if (format->recognises && format->recognises(head)) return format;
    return nullptr;
}

Observations read_by_format(const Receiver& receiver, const RecordingBytes& recording) {
    require_readable(recording);
    const Format* format = choose(receiver, recording);
    if (format && format->read) return format->read(receiver, recording);
    if (to_be_recognised(receiver)) refuse_unknown(recording);
    throw Failure(receiver.place.empty() ? "receiver " + receiver.id : receiver.place,
                  fmt::format("the format \"{}\" is not read", escape_for_message(receiver.format)),
                  fmt::format("Formats that are read: {}", formats_read()));
}

/// As the UTF-8 that every format reads. Lines and columns are the same, bytes are not.
Observations import_utf16(const Receiver& receiver, const RecordingBytes& recording) {
    const std::string text = utf8_of_utf16(recording);
    if (is_utf16(text))
        throw Failure(place_in(recording, 1, 1), "the UTF-16 text holds UTF-16 text again",
                      "Take the recording as the program wrote it");
    Observations observations = import_recording(receiver, {.name = recording.name, .bytes = text});
    for (Observation& row : observations.rows)
        row.source_byte.reset();
    observations.notes.push_back(
        "The recording is UTF-16 text: rows are traced to its lines, not to its bytes.");
    return observations;
}

}  // namespace

bool is_read_by_itself(const Receiver& receiver, const RecordingBytes& recording) {
    return !to_be_recognised(receiver) || is_utf16(recording.bytes) || choose(receiver, recording);
}

Observations import_recording(const Receiver& receiver, const RecordingBytes& recording) {
    if (is_utf16(recording.bytes)) return import_utf16(receiver, recording);
    Observations observations = read_by_format(receiver, recording);
    check(observations);
    return observations;
}

std::optional<StreamedRecording> import_streamed(const Receiver& receiver,
                                                 const RecordingBytes& recording) {
    if (recording.bytes.size() <= held_whole_bytes) return std::nullopt;
    const Format* format = choose(receiver, recording);
    if (!format || !format->read_streamed) return std::nullopt;
    require_readable(recording);
    return format->read_streamed(receiver, recording);
}

void note_origins_of_head(const Receiver& receiver, Observations& head) {
    const Format* format = find_format(head.format);
    head.time_origin = format ? format->time_origin : "";
    head.facts.time_source = format && format->stamps_satellite_time ? "satellites"
                             : receiver.time_source == "satellites"  ? "attempt"
                                                                     : "unknown";
    head.solution_source = SolutionSource::recording;
}

void note_origins(const Receiver& receiver, Observations& observations) {
    note_origins_of_head(receiver, observations);
    FixType claimed = FixType::unknown;
    from_text(receiver.solution, claimed);
    bool stated = false;
    bool missing = false;
    for (Observation& row : observations.rows) {
        if (row.fix != FixType::unknown) {
            stated = true;
            continue;
        }
        missing = true;
        row.fix = claimed;
    }
    if (missing)
        observations.solution_source = claimed != FixType::unknown ? SolutionSource::attempt
                                       : stated                    ? SolutionSource::partly
                                                                   : SolutionSource::unknown;
}

}  // namespace runcert
