#include <fmt/format.h>

#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/frame_reader.h"
#include "stages/import/sbp/device.h"

/// Locosys SBN logs, and any other log of SiRF binary messages: frames of 0xA0A2, length, payload,
/// checksum, 0xB0B3, the most significant byte first. Each message 41 (geodetic navigation data) is
/// an epoch; the others are passed over. Layout: SiRF Binary Protocol Reference Manual 2.4,
/// "Geodetic Navigation Data - Message ID 41", and for the six bytes that Locosys adds Logiqx,
/// "SBN - SiRF Binary".
namespace runcert::sbn {
namespace {

/// An epoch out of message 41.
struct GeodeticRow {
    /// Nothing where the receiver does not know the time yet: there is no epoch without one.
    std::optional<TimedRow> row;
    /// Leap seconds that the receiver's UTC counts with: GPS time less the UTC shown, to the
    /// nearest second. Nothing where the UTC shown is no time.
    std::optional<std::int64_t> leap_seconds;
};

constexpr std::string_view frame_start = "\xa0\xa2", frame_end = "\xb0\xb3";
constexpr std::size_t before_payload = 4, after_payload = 4;
/// A SiRF payload is shorter than 1 KiB; with the limit a damaged length costs little.
constexpr std::size_t longest_payload = 1023;

std::string_view payload_of(std::string_view frame) {
    return frame.substr(before_payload, frame.size() - before_payload - after_payload);
}

std::size_t announced_size(std::string_view ahead) {
    if (!ahead.starts_with(frame_start)) return 0;
    const std::size_t length =
        ahead.size() < before_payload ? 0 : big_endian<std::uint16_t>(ahead, 2);
    return before_payload + (length > longest_payload ? 0 : length) + after_payload;
}

bool is_good(std::string_view frame, std::size_t, RunningChecksum&) {
    const std::string_view payload = payload_of(frame);
    if (payload.empty() || !frame.ends_with(frame_end)) return false;
    unsigned sum = 0;
    for (const char c : payload)
        sum += static_cast<unsigned char>(c);
    return (sum & 0x7fff) == big_endian<std::uint16_t>(frame, frame.size() - after_payload);
}

constexpr FrameKind frame_kind{.size = announced_size, .is_good = is_good};

/// The fields of message 41, its number being byte 0; lengths in m, speeds in m/s, angles in
/// degrees.
namespace field {
template <class Integer>
using Number = NumberField<Integer, std::endian::big>;
constexpr Number<std::uint16_t> nav_type{3};
constexpr Number<std::uint16_t> week{5};  ///< the full one, of GPS
constexpr Number<std::uint32_t> of_week_ms{7};
constexpr Number<std::uint16_t> year{11};
constexpr Number<std::uint8_t> month{13}, day{14}, hour{15}, minute{16};
constexpr Number<std::uint16_t> of_minute_ms{17};  ///< UTC
constexpr Number<std::int32_t> latitude{23, 1e-7}, longitude{27, 1e-7}, ellipsoid_height{31, 0.01};
constexpr Number<std::uint8_t> datum{39};  ///< 21 is WGS 84
constexpr Number<std::uint16_t> speed{40, 0.01}, course{42, 0.01};
constexpr Number<std::int16_t> climb{46, 0.01};
constexpr Number<std::uint32_t> horizontal_error{50, 0.01}, vertical_error{54, 0.01};
constexpr Number<std::uint16_t> velocity_error{62, 0.01};  ///< horizontal
constexpr Number<std::uint8_t> satellites{88};
constexpr Number<std::uint8_t> sdop{95, 0.01}, vsdop{96, 0.01};  ///< Locosys' own
}  // namespace field

constexpr std::size_t message_bytes = 91, locosys_bytes = 97;
constexpr std::uint8_t wgs84 = 21;

constexpr const char* damaged =
    "The record is damaged; take the recording as the receiver wrote it";

/// An error estimate; empty if the field is zero or full, as receivers write an unknown one.
template <class Integer>
std::optional<double> error_estimate(const field::Number<Integer>& field,
                                     std::string_view payload) {
    const Integer value = field.whole(payload);
    // 0x7FFF...: receivers that count with signed numbers fill the field up to there.
    if (value == 0 || value == static_cast<Integer>(-1) ||
        (sizeof(Integer) > 1 && value == static_cast<Integer>(-1) / 2))
        return std::nullopt;
    return field.real(payload);
}

/// Bits 0 to 2: 0 no solution; 1 to 4 filtered from so many satellites; 5, 6 least squares in the
/// plane, in space; 7 dead reckoning. Bit 7: differential corrections were applied. What fewer than
/// three satellites make is carried on from before.
FixType fix_of(std::uint16_t nav_type) {
    const int kind = nav_type & 7;
    if (kind == 0) return FixType::none;
    if (kind < 3 || kind == 7) return FixType::dead_reckoning;
    return (nav_type & 0x80) != 0 ? FixType::dgps : FixType::single;
}

GpsTime read_instant(std::string_view payload, const RecordingBytes& recording,
                     const RecordPlace& place) {
    const std::int64_t of_week_ms = field::of_week_ms.whole(payload);
    try {
        return GpsTime::from_week(field::week.whole(payload), of_week_ms * 1'000'000);
    } catch (const Failure&) {
        throw Failure(place_in(recording, place),
                      fmt::format("a time of week of {} ms is impossible", of_week_ms), damaged);
    }
}

std::optional<std::int64_t> leap_seconds_of(std::string_view payload, GpsTime instant) {
    const std::uint16_t of_minute_ms = field::of_minute_ms.whole(payload);
    if (of_minute_ms >= 61'000) return std::nullopt;
    try {
        const GpsTime minute = GpsTime::from_calendar({.year = field::year.whole(payload),
                                                       .month = field::month.whole(payload),
                                                       .day = field::day.whole(payload),
                                                       .hour = field::hour.whole(payload),
                                                       .minute = field::minute.whole(payload)});
        return whole_seconds(instant.nanoseconds_since(
            minute.plus_nanoseconds(std::int64_t{of_minute_ms} * 1'000'000)));
    } catch (const Failure&) {
        return std::nullopt;
    }
}

void read_velocity(std::string_view payload, RecordedVelocity& velocity) {
    set_speed(velocity, field::speed.real(payload),
              Angle::from_degrees(field::course.real(payload)));
    velocity.recorded_velocity_up_m_s = field::climb.real(payload);
    // EHVE is of the vector; Locosys receivers leave it at zero and state SDOP, of the speed alone.
    const auto error = error_estimate(field::velocity_error, payload);
    if (error) set_velocity_accuracy(velocity, *error, 2);
    if (payload.size() < locosys_bytes) return;
    if (const auto sdop = error_estimate(field::sdop, payload); sdop && !error)
        set_velocity_accuracy(velocity, *sdop, 1);
    if (const auto vsdop = error_estimate(field::vsdop, payload))
        velocity.sigma_recorded_velocity_up_m_s = *vsdop;
}

void read_position(std::string_view payload, Observation& row, const RecordingBytes& recording,
                   const RecordPlace& place) {
    const std::uint8_t datum = field::datum.whole(payload);
    if (datum != wgs84 && datum != 0)
        throw Failure(
            place_in(recording, place),
            fmt::format("the position is in the receiver's map datum {}, not 21, WGS 84", datum),
            "Set the receiver to WGS 84 before recording");
    set_position(row, checked_geodetic({Angle::from_degrees(field::latitude.real(payload)),
                                        Angle::from_degrees(field::longitude.real(payload)),
                                        field::ellipsoid_height.real(payload)},
                                       recording, place));
    if (const auto error = error_estimate(field::horizontal_error, payload))
        set_radial_accuracy(row, *error);
    if (const auto error = error_estimate(field::vertical_error, payload)) row.sigma_up_m = *error;
}

/// Reads the payload of a message 41. Failure at its place.
GeodeticRow read_geodetic(std::string_view payload, const RecordingBytes& recording,
                          const RecordPlace& place) {
    if (payload.size() < message_bytes)
        throw Failure(
            place_in(recording, place),
            fmt::format("message 41 is {} bytes long, not {}", payload.size(), message_bytes),
            damaged);
    GeodeticRow result;
    const FixType fix = fix_of(field::nav_type.whole(payload));
    if (fix == FixType::none && field::week.whole(payload) == 0) return result;
    TimedRow& row = result.row.emplace();
    row.instant = read_instant(payload, recording, place);
    row.observation.fix = fix;
    row.observation.satellites = field::satellites.whole(payload);
    if (fix == FixType::none) return result;
    result.leap_seconds = leap_seconds_of(payload, row.instant);
    read_position(payload, row.observation, recording, place);
    read_velocity(payload, row.observation);
    return result;
}

constexpr char geodetic_message = 41, file_id_message = '\xfd';

/// Leap seconds that the receiver's UTC counted with, while they stayed the same.
struct LeapCount {
    std::int64_t used = 0;
    std::int64_t right = 0;  ///< of the date where it began
    std::size_t from_byte = 0;
};

std::int64_t right_leap_seconds(GpsTime instant) {
    CalendarTime minute = utc_from_gps(instant).time;
    const auto second = std::exchange(minute.second, 0);
    const auto nanosecond = std::exchange(minute.nanosecond, 0);
    return (instant.nanoseconds_since(GpsTime::from_calendar(minute)) - nanosecond) /
               GpsTime::nanoseconds_per_second -
           second;
}

/// Reads a log frame by frame.
class SbnReader {
  public:
    explicit SbnReader(const RecordingBytes& recording)
        : recording_(recording),
          timed_(recording, WrittenResolution{CoordinateUnit::degree, 1e-7, 1e-3}) {}

    Observations read() {
        FrameReader frames(recording_, frame_kind);
        while (const auto frame = frames.next()) {
            const RecordPlace place(frame->offset);
            if (frame->good())
                read_message(payload_of(frame->bytes), frame->offset, place);
            else
                timed_.count_bad(place, frames.failure_of(*frame));
        }
        set_rows(observations_, std::move(timed_));
        note_times();
        return std::move(observations_);
    }

  private:
    static constexpr std::size_t most_leap_counts = 8;

    void read_message(std::string_view payload, std::size_t offset, const RecordPlace& place) {
        if (payload[0] == file_id_message && observations_.device.empty()) {
            observations_.device = locosys_device(payload.substr(1));
            set_instrument(observations_, locosys_instrument(payload.substr(1)));
        }
        if (payload[0] != geodetic_message) return timed_.count_good();
        try {
            const GeodeticRow read = read_geodetic(payload, recording_, place);
            if (read.row) {
                timed_.add(*read.row, place);
                if (read.leap_seconds)
                    see_leap_seconds(*read.leap_seconds, read.row->instant, offset);
            } else {
                ++without_time_;
            }
        } catch (const Failure& failure) {
            return timed_.count_bad(place, failure);
        }
        timed_.count_good();
    }

    void see_leap_seconds(std::int64_t used, GpsTime instant, std::size_t byte) {
        if (!leap_counts_.empty() && leap_counts_.back().used == used) return;
        if (leap_counts_.size() < most_leap_counts)
            leap_counts_.push_back({used, right_leap_seconds(instant), byte});
    }

    void note_times() {
        std::vector<std::string>& notes = observations_.notes;
        if (without_time_ > 0)
            notes.push_back(fmt::format(
                "{} messages were recorded before the receiver knew the time, and are no epochs.",
                without_time_));
        for (const LeapCount& count : leap_counts_)
            if (count.used != count.right)
                notes.push_back(fmt::format(
                    "From byte {} on the recorded UTC is {} s behind GPS time where {} s are "
                    "right: the receiver had not estimated the leap seconds. The recorded GPS "
                    "time is used, which this does not touch.",
                    count.from_byte, count.used, count.right));
            else if (leap_counts_.size() > 1)
                notes.push_back(
                    fmt::format("From byte {} on the recorded UTC has the right leap seconds, {}.",
                                count.from_byte, count.used));
    }

    const RecordingBytes& recording_;
    RowCollector timed_;
    Observations observations_ = empty_observations("sbn", "geodetic", "gps");
    std::vector<LeapCount> leap_counts_;
    std::size_t without_time_ = 0;
};

bool recognises(std::string_view bytes) {
    const auto first = FrameReader({{}, bytes}, frame_kind).next();
    return first && first->good() && first->offset == 0;
}

/// Times are the message's GPS week and time of week; its UTC, which depends on the leap seconds
/// that the receiver has received by then, is compared with them and noted where it is off.
Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = SbnReader(recording).read();
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "sbn",
    .what = "Locosys SBN",
    .place = 40,
    .stamps_satellite_time = true,
    .time_origin = "GPS time of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::sbn
