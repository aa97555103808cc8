#include "stages/import/sbp/row.h"

#include <fmt/format.h>

#include <cstdint>

#include "core/failure.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"

namespace runcert::sbp {
namespace {

/// Where the fields of a record begin.
namespace field {
constexpr std::size_t satellites = 1;    // u8
constexpr std::size_t utc_ms = 2;        // u16, ms of the minute
constexpr std::size_t utc = 4;           // u32, packed
constexpr std::size_t latitude = 12;     // i32, 1e-7 degrees
constexpr std::size_t longitude = 16;    // i32, 1e-7 degrees
constexpr std::size_t height = 20;       // i32, cm above mean sea level
constexpr std::size_t speed = 24;        // u16, cm/s
constexpr std::size_t course = 26;       // u16, 0.01 degrees
constexpr std::size_t climb = 28;        // i16, cm/s
constexpr std::size_t speed_error = 30;  // u8, cm/s
constexpr std::size_t climb_error = 31;  // u8, cm/s
}  // namespace field

constexpr std::uint8_t saturated = 255;

/// The instant of the packed UTC (months since 2000 in 10 bits, day 5, hour 5, minute 6, second 6)
/// and the milliseconds of its minute, which may be rounded into a neighbouring second.
GpsTime read_instant(std::string_view record, const RecordingBytes& recording,
                     const RecordPlace& place) {
    const auto packed = little_endian<std::uint32_t>(record, field::utc);
    const int months = static_cast<int>(packed >> 22);
    const CalendarTime utc{.year = 2000 + (months - 1) / 12,
                           .month = months == 0 ? 0 : (months - 1) % 12 + 1,
                           .day = static_cast<int>(packed >> 17 & 31),
                           .hour = static_cast<int>(packed >> 12 & 31),
                           .minute = static_cast<int>(packed >> 6 & 63),
                           .second = static_cast<int>(packed & 63)};
    const auto of_minute_ms = little_endian<std::uint16_t>(record, field::utc_ms);
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
    set_speed(velocity, little_endian<std::uint16_t>(record, field::speed) * 0.01,
              Angle::from_degrees(little_endian<std::uint16_t>(record, field::course) * 0.01));
    velocity.recorded_velocity_up_m_s = little_endian<std::int16_t>(record, field::climb) * 0.01;
    if (!has_sdop) return;
    const auto error = little_endian<std::uint8_t>(record, field::speed_error);
    if (error != saturated) set_velocity_accuracy(velocity, error * 0.01, 1);
    const auto climb_error = little_endian<std::uint8_t>(record, field::climb_error);
    if (climb_error != saturated && climb_error != 0)
        velocity.sigma_recorded_velocity_up_m_s = climb_error * 0.01;
}

}  // namespace

Filled find_filled(std::string_view records) {
    Filled filled;
    for (std::size_t at = 0; at + record_bytes <= records.size(); at += record_bytes) {
        const std::string_view record = records.substr(at, record_bytes);
        filled.satellites = filled.satellites || record[field::satellites] != 0;
        filled.sdop = filled.sdop || little_endian<std::uint8_t>(record, field::speed_error) > 1;
        if (filled.satellites && filled.sdop) break;
    }
    return filled;
}

TimedRow read_row(std::string_view record, const Filled& filled, const RecordingBytes& recording,
                  const RecordPlace& place) {
    TimedRow row;
    row.instant = read_instant(record, recording, place);
    const auto satellites = little_endian<std::uint8_t>(record, field::satellites);
    const auto latitude = little_endian<std::int32_t>(record, field::latitude);
    const auto longitude = little_endian<std::int32_t>(record, field::longitude);
    if (filled.satellites) row.observation.satellites = satellites;
    if ((filled.satellites && satellites == 0) || (latitude == 0 && longitude == 0)) {
        row.observation.fix = FixType::none;
        return row;
    }
    set_position(row.observation,
                 checked_geodetic(
                     {Angle::from_degrees(latitude * 1e-7), Angle::from_degrees(longitude * 1e-7),
                      little_endian<std::int32_t>(record, field::height) * 0.01},
                     recording, place));
    read_velocity(record, filled.sdop, row.observation);
    return row;
}

}  // namespace runcert::sbp
