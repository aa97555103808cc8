#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/geodesy.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/sbp/device.h"

/// Locosys SBP logs (NaviGPS, GT-31, GW-52, GW-60, and loggers that write the same): a header of 64
/// bytes, then records of 32, least significant byte first, without checksums. Layout: gpsbabel's
/// navilink.h and sbp.cc; Logiqx, "SBP - SiRF Binary (Packed)", for the last two bytes.
namespace runcert::sbp {
namespace {

constexpr std::size_t record_bytes = 32;

/// Which fields of its records a logger fills in; older ones leave some at zero.
struct Filled {
    bool satellites = false;  ///< the count of satellites
    bool sdop = false;        ///< SDOP and VSDOP; without them the two bytes are flags
};

/// A step of the recorded UTC between two rows that is off the recording's rate by whole seconds.
struct UtcJump {
    std::size_t row = 0;       ///< index of the row after it
    std::int64_t seconds = 0;  ///< negative where UTC went back
};

/// The first jumps, and how many there are.
struct UtcJumps {
    static constexpr std::size_t listed_at_most = 3;
    std::vector<UtcJump> first;
    std::size_t count = 0;
};

/// The fields of a record; lengths in m, speeds in m/s, angles in degrees.
namespace field {
constexpr NumberField<std::uint8_t> satellites{1};
constexpr NumberField<std::uint16_t> of_minute_ms{2};
constexpr NumberField<std::uint32_t> utc{4};  ///< packed
constexpr NumberField<std::int32_t> latitude{12, 1e-7}, longitude{16, 1e-7};
constexpr NumberField<std::int32_t> height{20, 0.01};  ///< above mean sea level
constexpr NumberField<std::uint16_t> speed{24, 0.01}, course{26, 0.01};
constexpr NumberField<std::int16_t> climb{28, 0.01};
constexpr NumberField<std::uint8_t> speed_error{30, 0.01}, climb_error{31, 0.01};
}  // namespace field

constexpr std::uint8_t saturated = 255;

/// The instant of the packed UTC (months since 2000 in 10 bits, day 5, hour 5, minute 6, second 6)
/// and the milliseconds of its minute, which may be rounded into a neighbouring second.
GpsTime read_instant(std::string_view record, const RecordingBytes& recording,
                     const RecordPlace& place) {
    const std::uint32_t packed = field::utc.whole(record);
    const int months = static_cast<int>(packed >> 22);
    const CalendarTime utc{.year = 2000 + (months - 1) / 12,
                           .month = months == 0 ? 0 : (months - 1) % 12 + 1,
                           .day = static_cast<int>(packed >> 17 & 31),
                           .hour = static_cast<int>(packed >> 12 & 31),
                           .minute = static_cast<int>(packed >> 6 & 63),
                           .second = static_cast<int>(packed & 63)};
    const std::uint16_t of_minute_ms = field::of_minute_ms.whole(record);
    // Modulo 65536, because a logger that rounds down across the minute writes -1 ms as 65535.
    const auto of_second_ms =
        static_cast<std::int16_t>(static_cast<std::uint16_t>(of_minute_ms - utc.second * 1000));
    if (of_second_ms < -1000 || of_second_ms > 1000)
        throw Failure(place_in(recording, place),
                      fmt::format("the record's time has {} ms of the minute beside second {}",
                                  of_minute_ms, utc.second),
                      "The record is damaged; take the recording as the receiver wrote it");
    return instant_of_utc(utc, recording, place)
        .plus_nanoseconds(std::int64_t{of_second_ms} * 1'000'000);
}

void read_velocity(std::string_view record, bool has_sdop, RecordedVelocity& velocity) {
    set_speed(velocity, field::speed.real(record), Angle::from_degrees(field::course.real(record)));
    velocity.recorded_velocity_up_m_s = field::climb.real(record);
    if (!has_sdop) return;
    if (field::speed_error.whole(record) != saturated)
        set_velocity_accuracy(velocity, field::speed_error.real(record), 1);
    const std::uint8_t climb_error = field::climb_error.whole(record);
    if (climb_error != saturated && climb_error != 0)
        velocity.sigma_recorded_velocity_up_m_s = field::climb_error.real(record);
}

/// Looks through all the records. A logger without SDOP writes flags in its place, 0 or 1.
Filled find_filled(std::string_view records) {
    Filled filled;
    for (std::size_t at = 0; at + record_bytes <= records.size(); at += record_bytes) {
        const std::string_view record = records.substr(at, record_bytes);
        filled.satellites = filled.satellites || field::satellites.whole(record) != 0;
        filled.sdop = filled.sdop || field::speed_error.whole(record) > 1;
        if (filled.satellites && filled.sdop) break;
    }
    return filled;
}

/// The row of a record, `record_bytes` long, that begins at `place`. Failure there.
TimedRow read_row(std::string_view record, const Filled& filled, const RecordingBytes& recording,
                  const RecordPlace& place) {
    TimedRow row;
    row.instant = read_instant(record, recording, place);
    const std::uint8_t satellites = field::satellites.whole(record);
    if (filled.satellites) row.observation.satellites = satellites;
    if ((filled.satellites && satellites == 0) ||
        (field::latitude.whole(record) == 0 && field::longitude.whole(record) == 0)) {
        row.observation.fix = FixType::none;
        return row;
    }
    set_position(row.observation,
                 checked_geodetic({Angle::from_degrees(field::latitude.real(record)),
                                   Angle::from_degrees(field::longitude.real(record)),
                                   field::height.real(record)},
                                  recording, place));
    read_velocity(record, filled.sdop, row.observation);
    return row;
}

constexpr std::int64_t second_ns = GpsTime::nanoseconds_per_second;
constexpr std::int64_t most_leap_seconds = 20;
/// How far off the rate a stamp may be besides the jump.
constexpr std::int64_t jitter_ns = 20'000'000;
/// Slower than this, a movement does not show how long it took.
constexpr double least_speed_m_s = 2.0;

double speed_m_s(const Observation& row) {
    return std::hypot(row.recorded_velocity_east_m_s.value_or(0.0),
                      row.recorded_velocity_north_m_s.value_or(0.0));
}

Ecef place(const Observation& row) {
    return ecef_from_geodetic({Angle::from_degrees(*row.latitude_deg),
                               Angle::from_degrees(*row.longitude_deg), *row.height_m});
}

bool repeats(const Observation& row, const Observation& before) {
    return row.latitude_deg == before.latitude_deg && row.longitude_deg == before.longitude_deg &&
           row.height_m == before.height_m &&
           row.recorded_velocity_east_m_s == before.recorded_velocity_east_m_s &&
           row.recorded_velocity_north_m_s == before.recorded_velocity_north_m_s;
}

/// Whether the craft moved between two rows by what its speed makes in `nominal_s`, to a quarter.
bool moves_as_in(double nominal_s, const Observation& before, const Observation& row) {
    if (!before.latitude_deg || !row.latitude_deg) return false;
    const double mean_m_s = 0.5 * (speed_m_s(before) + speed_m_s(row));
    if (mean_m_s < least_speed_m_s) return false;
    const double moved_m = (place(row).m - place(before).m).norm();
    return std::abs(moved_m - mean_m_s * nominal_s) < 0.25 * mean_m_s * nominal_s;
}

/// The whole seconds by which a step differs from the nominal one; 0 where that is no jump.
std::int64_t jump_seconds(std::int64_t step_ns, std::int64_t nominal_ns) {
    if (step_ns > nominal_ns + (most_leap_seconds + 1) * second_ns ||
        step_ns < nominal_ns - (most_leap_seconds + 1) * second_ns)
        return 0;
    const std::int64_t off_ns = step_ns - nominal_ns;
    const std::int64_t seconds = whole_seconds(off_ns);
    return std::abs(off_ns - seconds * second_ns) <= jitter_ns ? seconds : 0;
}

/// Finds where a receiver that has UTC alone received the leap seconds: SiRF receivers count with
/// those of their firmware until they have received the almanac's. A step back is one unless the
/// row repeats the one before it; a step forward is one, and no gap, where the craft moved by what
/// its speed makes in one interval and not by what it makes in the time stamped. Needs times since
/// the first epoch and the nominal interval.
UtcJumps find_utc_jumps(const Observations& observations) {
    UtcJumps jumps;
    const double nominal_s = observations.facts.nominal_interval_s;
    if (!(nominal_s > 0.0 && nominal_s < 60.0)) return jumps;
    const auto nominal_ns = std::llround(nominal_s * 1e9);
    const std::vector<Observation>& rows = observations.rows;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        // A step may be longer than 64 bits of nanoseconds; their difference decides nothing then.
        std::int64_t step_ns = 0;
        if (__builtin_sub_overflow(rows[i].time.nanoseconds, rows[i - 1].time.nanoseconds,
                                   &step_ns))
            continue;
        const std::int64_t seconds = jump_seconds(step_ns, nominal_ns);
        if (seconds == 0) continue;
        if (seconds < 0 ? repeats(rows[i], rows[i - 1])
                        : !moves_as_in(nominal_s, rows[i - 1], rows[i]))
            continue;
        if (jumps.first.size() < UtcJumps::listed_at_most) jumps.first.push_back({i, seconds});
        ++jumps.count;
    }
    return jumps;
}

constexpr std::size_t header_bytes = 64;
/// Of the file identification's text in the header, after its length and the message's start.
constexpr std::size_t file_id_at = 7;
constexpr std::size_t frame_end_bytes = 4;

/// The text of the file identification in the header; empty where there is none.
std::string_view file_id_of(std::string_view header) {
    if (header.size() < file_id_at) return {};
    const std::size_t message = little_endian<std::uint16_t>(header, 0);
    const std::size_t end = std::min({message, header.size(), header_bytes});
    std::string_view text =
        header.substr(file_id_at, end > file_id_at ? end - file_id_at : std::size_t{0});
    if (text.size() >= frame_end_bytes && text.ends_with("\xb0\xb3"))
        text.remove_suffix(frame_end_bytes);  // its checksum may look like letters
    return text;
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

bool recognises(std::string_view bytes) {
    return bytes.size() >= header_bytes && little_endian<std::uint16_t>(bytes, 0) <= header_bytes &&
           bytes.substr(2, 2) == "\xa0\xa2" && bytes[6] == '\xfd';
}

/// No accuracy of positions is stated. SDOP, the error estimate of the speed over ground, is of
/// one number and not of a vector: each horizontal axis is given all of it, which is what an
/// error without a preferred direction has along any course.
Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    const std::string_view bytes = recording.bytes;
    const std::string_view records =
        written_records(bytes.substr(std::min(header_bytes, bytes.size())));
    const Filled filled = find_filled(records);
    Observations observations = empty_observations("sbp", "geodetic", "utc");
    observations.variant = filled.sdop ? "SBP with SDOP" : "SBP without SDOP";
    const std::string_view file_id = file_id_of(bytes.substr(0, header_bytes));
    observations.device = locosys_device(file_id);
    set_instrument(observations, locosys_instrument(file_id));
    set_rows(observations, read_rows(recording, filled, records));
    note_content(observations, filled);
    note_jumps(observations);
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "sbp",
    .what = "Locosys SBP",
    .place = 30,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::sbp
