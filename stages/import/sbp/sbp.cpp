#include "stages/import/sbp/sbp.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/failure.h"
#include "stages/import/byte_order.h"
#include "stages/import/format.h"
#include "stages/import/row_collector.h"
#include "stages/import/sbp/device.h"
#include "stages/import/sbp/jumps.h"
#include "stages/import/sbp/row.h"

namespace runcert::sbp {
namespace {

constexpr std::size_t header_bytes = 64;
/// Of the file identification's text in the header, after its length and the message's start.
constexpr std::size_t file_id_at = 7;
constexpr std::size_t frame_end_bytes = 4;

std::string read_device(std::string_view header) {
    if (header.size() < file_id_at) return {};
    const std::size_t message = little_endian<std::uint16_t>(header, 0);
    const std::size_t end = std::min({message, header.size(), header_bytes});
    std::string_view text =
        header.substr(file_id_at, end > file_id_at ? end - file_id_at : std::size_t{0});
    if (text.size() >= frame_end_bytes && text.ends_with("\xb0\xb3"))
        text.remove_suffix(frame_end_bytes);  // its checksum may look like letters
    return locosys_device(text);
}

/// The records without the room at the end of the file that was never written.
std::string_view written_records(std::string_view records) {
    for (const char blank : {'\xff', '\0'}) {
        const std::size_t last = records.find_last_not_of(blank);
        const std::size_t used = last == std::string_view::npos ? 0 : last + 1;
        const std::size_t whole = (used + record_bytes - 1) / record_bytes * record_bytes;
        if (whole < records.size()) return records.substr(0, whole);
    }
    return records;
}

RowCollector read_rows(const RecordingBytes& recording, const Filled& filled,
                       std::string_view records) {
    RowCollector timed(recording, WrittenResolution{CoordinateUnit::degree, 1e-7, 1e-3});
    std::size_t at = 0;
    for (; at + record_bytes <= records.size(); at += record_bytes) {
        const RecordPlace place(header_bytes + at);
        timed.add_record(place, [&] {
            return read_row(records.substr(at, record_bytes), filled, recording, place);
        });
    }
    if (at < records.size()) {
        const RecordPlace place(header_bytes + at);
        timed.count_bad(place, Failure(place_in(recording, place),
                                       fmt::format("the last record is cut off: {} bytes of {}",
                                                   records.size() - at, record_bytes),
                                       "Take the whole recording"));
    }
    return timed;
}

void note_jumps(Observations& observations) {
    const UtcJumps jumps = find_utc_jumps(observations);
    for (const UtcJump& jump : jumps.first)
        observations.notes.push_back(fmt::format(
            "The recorded UTC jumps {} by {} s between the records at byte {} and byte {}, against "
            "the recording's rate: a receiver that receives the leap seconds in mid-log does this. "
            "The times were left as they are recorded; one side of the jump is off by as much.",
            jump.seconds < 0 ? "back" : "ahead", std::abs(jump.seconds),
            *observations.rows[jump.row - 1].source_byte,
            *observations.rows[jump.row].source_byte));
    if (jumps.count > jumps.first.size())
        observations.notes.push_back(
            fmt::format("The recorded UTC jumps by whole seconds at {} further places.",
                        jumps.count - jumps.first.size()));
}

void note_content(Observations& observations, const Filled& filled) {
    const auto has_height = [](const Observation& row) { return row.height_m.has_value(); };
    if (std::any_of(observations.rows.begin(), observations.rows.end(), has_height))
        observations.notes.push_back(
            "Heights are recorded above mean sea level, and were taken as they are: they differ "
            "from ellipsoidal heights by the height of the geoid.");
    if (!filled.sdop)
        observations.notes.push_back(
            "The recording states no accuracy of speed: its logger does not fill in SDOP.");
}

}  // namespace

bool recognises(std::string_view bytes) {
    return bytes.size() >= header_bytes && little_endian<std::uint16_t>(bytes, 0) <= header_bytes &&
           bytes.substr(2, 2) == "\xa0\xa2" && bytes[6] == '\xfd';
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    const std::string_view bytes = recording.bytes;
    const std::string_view records =
        written_records(bytes.substr(std::min(header_bytes, bytes.size())));
    const Filled filled = find_filled(records);
    Observations observations;
    observations.format = "sbp";
    observations.variant = filled.sdop ? "SBP with SDOP" : "SBP without SDOP";
    observations.device = read_device(bytes.substr(0, header_bytes));
    observations.frame = "geodetic";
    observations.time_scale = "utc";
    set_rows(observations, read_rows(recording, filled, records));
    note_content(observations, filled);
    note_jumps(observations);
    apply_attempt(observations, receiver);
    return observations;
}

extern const Format format{
    .name = "sbp",
    .what = "Locosys SBP",
    .place = 30,
    .of_satellites = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::sbp
