#include "stages/import/oao/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"

namespace runcert::oao {
namespace {

constexpr char second_byte = 0x0A;
constexpr std::size_t header_length = 512;

// Where the fields of an epoch begin.
constexpr std::size_t latitude_at = 4;           // int32, 1e-7 degrees
constexpr std::size_t longitude_at = 8;          // int32, 1e-7 degrees
constexpr std::size_t height_at = 12;            // int32, mm above mean sea level
constexpr std::size_t speed_at = 16;             // uint32, mm/s over ground
constexpr std::size_t course_at = 20;            // uint32, 1e-5 degrees
constexpr std::size_t time_at = 24;              // uint64, ms since 1970-01-01 UTC
constexpr std::size_t fix_at = 32;               // uint8, fixType of UBX-NAV-PVT
constexpr std::size_t satellites_at = 33;        // uint8
constexpr std::size_t speed_sigma_at = 34;       // uint32, mm/s
constexpr std::size_t horizontal_sigma_at = 38;  // uint32, mm
constexpr std::size_t vertical_sigma_at = 42;    // uint32, mm; then heading accuracy and DOP

// And of a header.
constexpr std::size_t identifier_at = 4;  // uint16
constexpr std::size_t nickname_at = 6;    // 10 characters
constexpr std::size_t nickname_length = 10;
constexpr std::size_t firmware_at = 424;  // uint16; zero in older loggers
constexpr std::size_t signature_at = 448;

constexpr std::int64_t ms_per_day = 86'400'000;
constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr std::int64_t first_ms = 315'964'800'000;   // 1980-01-06, the GPS epoch
constexpr std::int64_t last_ms = 7'258'118'400'000;  // 2200-01-01

constexpr double degrees_per_step = 1e-7;
constexpr std::uint32_t full_circle = 36'000'000;

[[noreturn]] void refuse(const RecordingBytes& recording, const RecordPlace& place,
                         const std::string& what) {
    throw Failure(place_in(recording, place), what,
                  "The record is damaged; take the recording as the logger wrote it");
}

FixType fix_of(unsigned char type, const RecordingBytes& recording, const RecordPlace& place) {
    switch (type) {
        case 0:
        case 5:  // time only
            return FixType::none;
        case 1:
        case 4:  // satellites and dead reckoning together
            return FixType::dead_reckoning;
        case 2:
        case 3:
            return FixType::single;
        default:
            refuse(recording, place,
                   fmt::format("the kind of fix is {}; u-blox has 0 to 5", unsigned{type}));
    }
}

/// A stated standard deviation in units of 1; nothing where it is zero or stands at its limit.
std::optional<double> deviation(std::string_view frame, std::size_t at) {
    const auto thousandths = little_endian<std::uint32_t>(frame, at);
    if (thousandths == 0 || thousandths == std::numeric_limits<std::uint32_t>::max())
        return std::nullopt;
    return thousandths * 1e-3;
}

/// Puts position and velocity, with their accuracies, into a row whose fix has them.
void read_solution(std::string_view frame, const RecordingBytes& recording,
                   const RecordPlace& place, Observation& row) {
    const auto degrees = [&](std::size_t at) {
        return Angle::from_degrees(little_endian<std::int32_t>(frame, at) * degrees_per_step);
    };
    set_position(
        row, checked_geodetic({.latitude = degrees(latitude_at),
                               .longitude = degrees(longitude_at),
                               .height_m = little_endian<std::int32_t>(frame, height_at) * 1e-3},
                              recording, place));
    const auto course = little_endian<std::uint32_t>(frame, course_at);
    if (course > full_circle)
        refuse(recording, place,
               fmt::format("a course of {} degrees is impossible", course * 1e-5));
    set_speed(row, little_endian<std::uint32_t>(frame, speed_at) * 1e-3,
              Angle::from_degrees(course * 1e-5));
    if (const auto sigma_m = deviation(frame, horizontal_sigma_at))
        set_radial_accuracy(row, *sigma_m);
    row.sigma_up_m = deviation(frame, vertical_sigma_at);
    if (const auto sigma_m_s = deviation(frame, speed_sigma_at))
        set_velocity_accuracy(row, *sigma_m_s, 2);
}

}  // namespace

std::size_t announced_length(std::string_view bytes, std::size_t at) {
    if (bytes.size() - at < 2 || bytes[at + 1] != second_byte) return 0;
    switch (static_cast<FrameKind>(bytes[at])) {
        case FrameKind::header:
            return header_length;
        case FrameKind::track:
            return 12;
        case FrameKind::emergency:
        case FrameKind::point_of_interest:
            return 34;
        case FrameKind::epoch_on_the_second:
        case FrameKind::epoch_between_seconds:
            return epoch_length;
        case FrameKind::inertial:
            return 32;
    }
    return 0;
}

std::string_view frame_at(std::string_view bytes, std::size_t at) {
    const std::size_t length = announced_length(bytes, at);
    if (length == 0 || bytes.size() - at < length) return {};
    const std::string_view frame = bytes.substr(at, length);
    std::uint32_t first = 0, second = 0;
    const auto take = [&](char byte) { second += first += static_cast<unsigned char>(byte); };
    take(frame[0]);
    take(frame[1]);
    for (std::size_t i = 4; i < length; ++i)
        take(frame[i]);
    const bool good = (first & 0xFF) == static_cast<unsigned char>(frame[2]) &&
                      (second & 0xFF) == static_cast<unsigned char>(frame[3]);
    return good ? frame : std::string_view();
}

std::size_t find_frame(std::string_view bytes, std::size_t from) {
    for (std::size_t second = bytes.find(second_byte, from + 1); second != std::string_view::npos;
         second = bytes.find(second_byte, second + 1))
        if (!frame_at(bytes, second - 1).empty()) return second - 1;
    return bytes.size();
}

FrameKind kind_of(std::string_view frame) {
    return static_cast<FrameKind>(frame[0]);
}

GpsTime EpochReader::instant(std::int64_t unix_ms, const RecordPlace& place) {
    if (unix_ms < first_ms || unix_ms >= last_ms)
        refuse(recording_, place,
               fmt::format("the time, {} ms since 1970, is not between 1980 and 2200", unix_ms));
    const std::int64_t day = unix_ms / ms_per_day;
    if (day != day_) {
        const std::chrono::year_month_day date{std::chrono::sys_days{std::chrono::days{day}}};
        midnight_ = instant_of_utc({.year = static_cast<int>(date.year()),
                                    .month = static_cast<int>(unsigned{date.month()}),
                                    .day = static_cast<int>(unsigned{date.day()})},
                                   recording_, place);
        day_ = day;
    }
    return midnight_.plus_nanoseconds(unix_ms % ms_per_day * ns_per_ms);
}

TimedRow EpochReader::read(std::string_view frame, const RecordPlace& place) {
    TimedRow row;
    row.instant = instant(little_endian<std::int64_t>(frame, time_at), place);
    row.observation.fix = fix_of(static_cast<unsigned char>(frame[fix_at]), recording_, place);
    row.observation.satellites =
        static_cast<std::int16_t>(static_cast<unsigned char>(frame[satellites_at]));
    // Without a fix the logger repeats or extrapolates the last position.
    if (row.observation.fix != FixType::none)
        read_solution(frame, recording_, place, row.observation);
    return row;
}

std::string device_of(std::string_view header) {
    std::string device =
        fmt::format("logger {}", little_endian<std::uint16_t>(header, identifier_at));
    const std::string_view field = header.substr(nickname_at, nickname_length);
    const std::string_view nickname = trim(field.substr(0, field.find('\0')));
    if (!nickname.empty()) device += fmt::format(" \"{}\"", escape_for_message(nickname));
    if (const auto firmware = little_endian<std::uint16_t>(header, firmware_at))
        device += fmt::format(", firmware {}", firmware);
    return device;
}

bool is_signed(std::string_view header) {
    const std::string_view signature = header.substr(signature_at);
    return std::any_of(signature.begin(), signature.end(), [](char c) { return c != '\0'; });
}

}  // namespace runcert::oao
