#include "stages/import/sbn/row.h"

#include <fmt/format.h>

#include <cstdint>

#include "core/failure.h"
#include "stages/import/byte_order.h"
#include "stages/import/earth.h"

namespace runcert::sbn {
namespace {

/// Where the fields of message 41 begin, its number being byte 0.
namespace field {
constexpr std::size_t nav_type = 3;           // u16, bits
constexpr std::size_t week = 5;               // u16, full GPS week
constexpr std::size_t time_of_week = 7;       // u32, ms
constexpr std::size_t year = 11;              // u16
constexpr std::size_t month = 13;             // u8, and day, hour, minute
constexpr std::size_t utc_ms = 17;            // u16, ms of the minute
constexpr std::size_t latitude = 23;          // i32, 1e-7 degrees
constexpr std::size_t longitude = 27;         // i32, 1e-7 degrees
constexpr std::size_t ellipsoid_height = 31;  // i32, cm
constexpr std::size_t datum = 39;             // u8, 21 is WGS 84
constexpr std::size_t speed = 40;             // u16, cm/s
constexpr std::size_t course = 42;            // u16, 0.01 degrees
constexpr std::size_t climb = 46;             // i16, cm/s
constexpr std::size_t horizontal_error = 50;  // u32, cm
constexpr std::size_t vertical_error = 54;    // u32, cm
constexpr std::size_t velocity_error = 62;    // u16, cm/s, horizontal
constexpr std::size_t satellites = 88;        // u8
constexpr std::size_t sdop = 95;              // u8, cm/s; Locosys
constexpr std::size_t vsdop = 96;             // u8, cm/s; Locosys
}  // namespace field

constexpr std::size_t message_bytes = 91;
constexpr std::size_t locosys_bytes = 97;
constexpr std::uint8_t wgs84 = 21;

constexpr std::string_view damaged =
    "The record is damaged; take the recording as the receiver wrote it";

template <class Integer>
Integer number(std::string_view payload, std::size_t at) {
    return big_endian<Integer>(payload, at);
}

/// An error estimate in hundredths; nothing where it is zero or the field is full, which mean that
/// it is not known.
template <class Integer>
std::optional<double> error_estimate(std::string_view payload, std::size_t at) {
    const auto value = number<Integer>(payload, at);
    // 0x7FFF...: receivers that count with signed numbers fill the field up to there.
    if (value == 0 || value == static_cast<Integer>(-1) ||
        (sizeof(Integer) > 1 && value == static_cast<Integer>(-1) / 2))
        return std::nullopt;
    return value * 0.01;
}

/// Bits 0 to 2: 0 no solution; 1 to 4 filtered from so many satellites; 5, 6 least squares in the
/// plane, in space; 7 dead reckoning. Bit 7: differential corrections were applied. What fewer than
/// three satellites make is carried on from before.
FixType fix_of(std::uint16_t nav_type) {
    switch (nav_type & 7) {
        case 0:
            return FixType::none;
        case 1:
        case 2:
        case 7:
            return FixType::dead_reckoning;
        default:
            return (nav_type & 0x80) != 0 ? FixType::dgps : FixType::single;
    }
}

GpsTime read_instant(std::string_view payload, const RecordingBytes& recording,
                     const RecordPlace& place) {
    const std::int64_t of_week_ms = number<std::uint32_t>(payload, field::time_of_week);
    try {
        return GpsTime::from_week(number<std::uint16_t>(payload, field::week),
                                  of_week_ms * 1'000'000);
    } catch (const Failure&) {
        throw Failure(place_in(recording, place),
                      fmt::format("a time of week of {} ms is impossible", of_week_ms),
                      std::string(damaged));
    }
}

std::optional<std::int64_t> leap_seconds_of(std::string_view payload, GpsTime instant) {
    const auto part = [&](std::size_t i) {
        return static_cast<int>(number<std::uint8_t>(payload, field::month + i));
    };
    const auto of_minute_ms = number<std::uint16_t>(payload, field::utc_ms);
    if (of_minute_ms >= 61'000) return std::nullopt;
    try {
        const GpsTime minute =
            GpsTime::from_calendar({.year = number<std::uint16_t>(payload, field::year),
                                    .month = part(0),
                                    .day = part(1),
                                    .hour = part(2),
                                    .minute = part(3)});
        const GpsTime shown = minute.plus_nanoseconds(std::int64_t{of_minute_ms} * 1'000'000);
        const std::int64_t ahead_ns = instant.nanoseconds_since(shown);
        constexpr std::int64_t half_ns = GpsTime::nanoseconds_per_second / 2;
        return (ahead_ns + (ahead_ns < 0 ? -half_ns : half_ns)) / GpsTime::nanoseconds_per_second;
    } catch (const Failure&) {
        return std::nullopt;
    }
}

void read_velocity(std::string_view payload, RecordedVelocity& velocity) {
    set_speed(velocity, number<std::uint16_t>(payload, field::speed) * 0.01,
              Angle::from_degrees(number<std::uint16_t>(payload, field::course) * 0.01));
    velocity.recorded_velocity_up_m_s = number<std::int16_t>(payload, field::climb) * 0.01;
    // EHVE is of the vector; Locosys receivers leave it at zero and state SDOP, of the speed alone.
    if (const auto error = error_estimate<std::uint16_t>(payload, field::velocity_error)) {
        set_velocity_accuracy(velocity, *error, 2);
    } else if (payload.size() >= locosys_bytes) {
        if (const auto sdop = error_estimate<std::uint8_t>(payload, field::sdop))
            set_velocity_accuracy(velocity, *sdop, 1);
    }
    if (payload.size() >= locosys_bytes)
        if (const auto vsdop = error_estimate<std::uint8_t>(payload, field::vsdop))
            velocity.sigma_recorded_velocity_up_m_s = *vsdop;
}

void read_position(std::string_view payload, Observation& row, const RecordingBytes& recording,
                   const RecordPlace& place) {
    const auto datum = number<std::uint8_t>(payload, field::datum);
    if (datum != wgs84 && datum != 0)
        throw Failure(
            place_in(recording, place),
            fmt::format("the position is in the receiver's map datum {}, not 21, WGS 84", datum),
            "Set the receiver to WGS 84 before recording");
    set_position(row,
                 checked_geodetic(
                     {Angle::from_degrees(number<std::int32_t>(payload, field::latitude) * 1e-7),
                      Angle::from_degrees(number<std::int32_t>(payload, field::longitude) * 1e-7),
                      number<std::int32_t>(payload, field::ellipsoid_height) * 0.01},
                     recording, place));
    if (const auto error = error_estimate<std::uint32_t>(payload, field::horizontal_error))
        set_radial_accuracy(row, *error);
    if (const auto error = error_estimate<std::uint32_t>(payload, field::vertical_error))
        row.sigma_up_m = *error;
}

}  // namespace

GeodeticRow read_geodetic(std::string_view payload, const RecordingBytes& recording,
                          const RecordPlace& place) {
    if (payload.size() < message_bytes)
        throw Failure(
            place_in(recording, place),
            fmt::format("message 41 is {} bytes long, not {}", payload.size(), message_bytes),
            std::string(damaged));
    GeodeticRow result;
    const FixType fix = fix_of(number<std::uint16_t>(payload, field::nav_type));
    if (fix == FixType::none && number<std::uint16_t>(payload, field::week) == 0) return result;
    TimedRow& row = result.row.emplace();
    row.instant = read_instant(payload, recording, place);
    row.observation.fix = fix;
    row.observation.satellites = number<std::uint8_t>(payload, field::satellites);
    if (fix == FixType::none) return result;
    result.leap_seconds = leap_seconds_of(payload, row.instant);
    read_position(payload, row.observation, recording, place);
    read_velocity(payload, row.observation);
    return result;
}

}  // namespace runcert::sbn
