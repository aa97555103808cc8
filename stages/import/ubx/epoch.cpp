#include "stages/import/ubx/epoch.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/geodesy.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"

// Layouts: u-blox "F9 HPG interface description" (UBX-22008968), section 3.15, and "u-blox 8 / M8
// receiver description" (UBX-13003221), section 32.17, for SOL and STATUS. All numbers are little
// endian.

namespace runcert::ubx {
namespace {

template <class Integer>
Integer number(std::string_view payload, std::size_t at) {
    return little_endian<Integer>(payload, at);
}

bool bit(std::string_view payload, std::size_t at, unsigned place) {
    return (static_cast<unsigned char>(payload[at]) >> place) & 1U;
}

double real(std::string_view payload, std::size_t at) {
    return std::bit_cast<float>(number<std::uint32_t>(payload, at));
}

/// Accuracies in units of 1 / `units_per_metre`; the largest number stands for "unknown".
double accuracy(std::string_view payload, std::size_t at, double units_per_metre) {
    const auto value = number<std::uint32_t>(payload, at);
    return value == 0xffffffffU ? 0.0 : value / units_per_metre;
}

/// A UTC time that a receiver rounds to its second and a signed rest.
struct RoundedUtc {
    CalendarTime second;
    std::int32_t rest_ns = 0;
    bool valid = false;
};

/// Year, month, day, hour, minute and second from `at` on.
CalendarTime calendar(std::string_view payload, std::size_t at) {
    const auto byte = [&](std::size_t i) { return number<std::uint8_t>(payload, at + i); };
    return {.year = number<std::uint16_t>(payload, at),
            .month = byte(2),
            .day = byte(3),
            .hour = byte(4),
            .minute = byte(5),
            .second = byte(6)};
}

RoundedUtc utc_of(const Epoch& epoch) {
    if (epoch.has(Part::pvt)) {
        const std::string_view pvt = epoch[Part::pvt];
        return {.second = calendar(pvt, 4),
                .rest_ns = number<std::int32_t>(pvt, 16),
                .valid = bit(pvt, 11, 0) && bit(pvt, 11, 1)};
    }
    const std::string_view time = epoch[Part::timeutc];
    return {.second = calendar(time, 12),
            .rest_ns = number<std::int32_t>(time, 8),
            .valid = bit(time, 19, 2)};
}

/// fixType of PVT, gpsFix of SOL: the solutions of both are numbered alike (fix_of_ublox).
constexpr std::uint8_t two_dimensional = 2, three_dimensional = 3, with_dead_reckoning = 4;

std::uint8_t solution_type(const Epoch& epoch) {
    if (epoch.has(Part::pvt)) return number<std::uint8_t>(epoch[Part::pvt], 20);
    if (epoch.has(Part::sol)) return number<std::uint8_t>(epoch[Part::sol], 10);
    return epoch.has(Part::status) ? number<std::uint8_t>(epoch[Part::status], 4)
                                   : std::uint8_t{three_dimensional};
}

/// PVT's carrSoln is of receivers that resolve ambiguities. A solution that is combined with dead
/// reckoning counts as that: its errors are no longer those of satellites alone.
FixType fix_of_pvt(std::string_view pvt) {
    const bool position_is_bad = pvt.size() >= 92 && bit(pvt, 78, 0);
    if (!bit(pvt, 21, 0) || position_is_bad) return FixType::none;
    const FixType fix = fix_of_ublox(number<std::uint8_t>(pvt, 20));
    if (fix != FixType::single) return fix;
    const int carrier = static_cast<unsigned char>(pvt[21]) >> 6;
    if (carrier == 1) return FixType::float_ambiguities;
    if (carrier == 2) return FixType::fixed;
    return bit(pvt, 21, 1) ? FixType::dgps : FixType::single;
}

/// Of SOL and STATUS, in which type and flags stand behind one another from `at` on.
FixType fix_at(std::string_view payload, std::size_t at) {
    if (!bit(payload, at + 1, 0)) return FixType::none;
    const FixType fix = fix_of_ublox(number<std::uint8_t>(payload, at));
    return fix == FixType::single && bit(payload, at + 1, 1) ? FixType::dgps : fix;
}

FixType fix_of(const Epoch& epoch) {
    if (epoch.has(Part::pvt)) return fix_of_pvt(epoch[Part::pvt]);
    if (epoch.has(Part::sol)) return fix_at(epoch[Part::sol], 10);
    if (!epoch.has(Part::status)) return FixType::unknown;
    const std::string_view status = epoch[Part::status];
    const FixType fix = fix_at(status, 4);
    // carrSoln, which receivers that resolve no ambiguities leave zero.
    const int carrier = static_cast<unsigned char>(status[7]) >> 6;
    const bool is_single_or_differential = fix == FixType::single || fix == FixType::dgps;
    if (is_single_or_differential && carrier == 1) return FixType::float_ambiguities;
    return is_single_or_differential && carrier == 2 ? FixType::fixed : fix;
}

/// How far GPS time is ahead of UTC (s); nothing where that is not announced.
std::optional<std::int64_t> leap_seconds_at(GpsTime time) {
    UtcTime utc = utc_from_gps(time);
    if (!utc.leap_seconds_known) return std::nullopt;
    utc.time.second = std::min(utc.time.second, 59);
    return time.nanoseconds_since(GpsTime::from_calendar(utc.time)) /
           GpsTime::nanoseconds_per_second;
}

/// The instant, a rollover or two of the GPS week later, at which there were as many leap seconds
/// as the receiver counts; nothing where it counts no more than there were at the instant itself.
/// No receiver knows of leap seconds to come years later, whereas old ones lose 1024 weeks.
std::optional<GpsTime> after_rollovers(GpsTime shown, std::int64_t counted) {
    constexpr std::int64_t rollover_ns = 1024 * GpsTime::nanoseconds_per_week;
    const auto then = leap_seconds_at(shown);
    if (!then || counted <= *then) return std::nullopt;
    for (const std::int64_t rollovers : {1, 2}) {
        const GpsTime later = shown.plus_nanoseconds(rollovers * rollover_ns);
        if (leap_seconds_at(later) == counted) return later;
    }
    return std::nullopt;
}

/// GPS week, time of week and the rest to it, as TIMEGPS and SOL have them; nothing where the
/// receiver did not know them.
std::optional<GpsTime> gps_time_in(std::string_view payload, bool timegps,
                                   std::uint32_t time_of_week_ms) {
    const unsigned first_valid = timegps ? 0 : 2;
    if (!bit(payload, 11, first_valid) || !bit(payload, 11, first_valid + 1)) return std::nullopt;
    return GpsTime()
        .plus_nanoseconds(number<std::int16_t>(payload, 8) * GpsTime::nanoseconds_per_week)
        .plus_nanoseconds(std::int64_t{time_of_week_ms} * 1'000'000 +
                          number<std::int32_t>(payload, 4));
}

std::optional<GpsTime> gps_time_of(const Epoch& epoch) {
    const bool timegps = epoch.has(Part::timegps);
    return gps_time_in(epoch[timegps ? Part::timegps : Part::sol], timegps, epoch.time_of_week_ms);
}

/// SOL's Earth-centred position or velocity, m or m/s.
Eigen::Vector3d centimetres_at(std::string_view sol, std::size_t at) {
    Eigen::Vector3d metres;
    for (std::size_t i = 0; i < 3; ++i)
        metres[static_cast<Eigen::Index>(i)] = number<std::int32_t>(sol, at + 4 * i) / 1e2;
    return metres;
}

/// Longitude, latitude (1e-7 degrees), height above the ellipsoid (mm) from `at` on, as PVT and
/// POSLLH have them.
Geodetic position_at(std::string_view payload, std::size_t at) {
    return {.latitude = Angle::from_degrees(number<std::int32_t>(payload, at + 4) / 1e7),
            .longitude = Angle::from_degrees(number<std::int32_t>(payload, at) / 1e7),
            .height_m = number<std::int32_t>(payload, at + 8) / 1e3};
}

/// The same with HPPOSLLH's further digits: 1e-9 degrees and 0.1 mm.
Geodetic high_precision_position(std::string_view hp) {
    const auto joined = [&](std::size_t coarse, std::size_t fine, std::int64_t steps) {
        return static_cast<double>(number<std::int32_t>(hp, coarse) * steps +
                                   number<std::int8_t>(hp, fine));
    };
    return {.latitude = Angle::from_degrees(joined(12, 25, 100) / 1e9),
            .longitude = Angle::from_degrees(joined(8, 24, 100) / 1e9),
            .height_m = joined(16, 26, 10) / 1e4};
}

/// The covariance towards east, north, up of COV's six numbers towards north, east, down.
Eigen::Matrix3d covariance_at(std::string_view cov, std::size_t at) {
    const auto term = [&](std::size_t i) { return real(cov, at + 4 * i); };
    const double nn = term(0), ne = term(1), nd = term(2), ee = term(3), ed = term(4), dd = term(5);
    Eigen::Matrix3d covariance;
    covariance << ee, ne, -ed, ne, nn, -nd, -ed, -nd, dd;
    return covariance;
}

/// Whether COV states a covariance whose variances are finite and positive.
bool is_usable(const Eigen::Matrix3d& covariance) {
    return covariance.allFinite() && (covariance.diagonal().array() > 0.0).all();
}

void set_position_accuracy(StatedAccuracy& row, std::string_view payload, std::size_t horizontal,
                           double units_per_metre) {
    set_radial_accuracy(row, accuracy(payload, horizontal, units_per_metre));
    const double up_m = accuracy(payload, horizontal + 4, units_per_metre);
    if (up_m > 0.0) row.sigma_up_m = up_m;
}

/// Velocity towards north, east, down from `at` on, and its accuracy, in units of 1 /
/// `units_per_m_s`.
void set_velocity_of(Observation& row, std::string_view payload, std::size_t at,
                     std::size_t accuracy_at, double units_per_m_s) {
    const auto component = [&](std::size_t i) {
        return number<std::int32_t>(payload, at + 4 * i) / units_per_m_s;
    };
    set_velocity(row, component(1), component(0));
    row.recorded_velocity_up_m_s = 0.0 - component(2);
    set_velocity_accuracy(row, accuracy(payload, accuracy_at, units_per_m_s), 3);
}

/// SOL's velocity, turned at the row's position.
void set_velocity_of_solution(Observation& row, std::string_view sol) {
    const Eigen::Vector3d enu_m_s =
        rotation_enu_from_ecef(Angle::from_degrees(*row.latitude_deg),
                               Angle::from_degrees(*row.longitude_deg)) *
        centimetres_at(sol, 28);
    set_velocity(row, enu_m_s[0], enu_m_s[1]);
    row.recorded_velocity_up_m_s = enu_m_s[2];
    set_velocity_accuracy(row, accuracy(sol, 40, 1e2), 3);
}

void set_covariances(Observation& row, std::string_view cov) {
    const Eigen::Matrix3d position_m2 = covariance_at(cov, 16);
    const Eigen::Matrix3d velocity_m2ps2 = covariance_at(cov, 40);
    if (number<std::uint8_t>(cov, 5) == 1 && is_usable(position_m2))
        static_cast<StatedAccuracy&>(row) = accuracy_from_covariance(position_m2);
    if (number<std::uint8_t>(cov, 6) != 1 || !is_usable(velocity_m2ps2) ||
        !row.recorded_velocity_east_m_s)
        return;
    row.sigma_recorded_velocity_east_m_s = std::sqrt(velocity_m2ps2(0, 0));
    row.sigma_recorded_velocity_north_m_s = std::sqrt(velocity_m2ps2(1, 1));
    row.sigma_recorded_velocity_up_m_s = std::sqrt(velocity_m2ps2(2, 2));
}

}  // namespace

std::optional<Part> part_of(const Frame& frame) {
    const auto message = std::ranges::find(part_messages, id_of(frame.bytes), &PartMessage::id);
    if (message == part_messages.end()) return std::nullopt;
    const auto part = static_cast<Part>(message - part_messages.begin());
    const std::size_t bytes = payload_of(frame).size();
    const bool fits = part == Part::pvt ? bytes >= message->bytes : bytes == message->bytes;
    return fits ? std::optional(part) : std::nullopt;
}

std::uint32_t time_of_week_ms(Part part, std::string_view payload) {
    return number<std::uint32_t>(payload, part == Part::hpposllh ? 4 : 0);
}

std::optional<GpsTime> RowMaker::by_another_epoch(std::uint32_t time_of_week_ms) {
    if (!dated_ && !std::exchange(looked_for_, true)) {
        FrameReader frames(recording_, frame_kind);
        for (auto frame = frames.next(); frame && !dated_; frame = frames.next())
            if (frame->good() && part_of(*frame) == Part::timegps)
                dated_ = gps_time_in(payload_of(*frame), true,
                                     ubx::time_of_week_ms(Part::timegps, payload_of(*frame)));
    }
    if (!dated_) return std::nullopt;
    constexpr std::int64_t week = GpsTime::nanoseconds_per_week;
    std::int64_t off = std::int64_t{time_of_week_ms} * 1'000'000 - dated_->nanoseconds_of_week();
    if (off > week / 2) off -= week;
    if (off < -week / 2) off += week;
    ++tally_.by_week;
    return dated_->plus_nanoseconds(off);
}

FixType RowMaker::fix_by_status(const Epoch& epoch) {
    if (!status_) return FixType::unknown;
    const std::uint32_t then = time_of_week_ms(Part::status, payload_of(*status_));
    if (epoch.time_of_week_ms < then || epoch.time_of_week_ms - then >= 1000)
        return FixType::unknown;
    Epoch with_status = epoch;
    with_status.parts[static_cast<std::size_t>(Part::status)] = status_;
    return fix_of(with_status);
}

std::optional<GpsTime> RowMaker::instant(const Epoch& epoch) {
    if (!epoch.has_time()) {
        const std::optional<GpsTime> time = by_another_epoch(epoch.time_of_week_ms);
        if (!time) ++tally_.without_time;
        return time;
    }
    if (!epoch.has_utc()) {
        const std::optional<GpsTime> time = gps_time_of(epoch);
        if (!time) ++tally_.without_time;
        if (time && epoch.has(Part::timegps)) dated_ = time;
        if (!time || !epoch.has(Part::timegps) || !bit(epoch[Part::timegps], 11, 2)) return time;
        return in_true_week(*time, number<std::int8_t>(epoch[Part::timegps], 10)).value_or(*time);
    }
    const RoundedUtc utc = utc_of(epoch);
    if (!utc.valid) {
        ++tally_.without_time;
        return std::nullopt;
    }
    ++tally_.in_utc;
    const GpsTime shown =
        instant_of_utc(utc.second, recording_, epoch.place()).plus_nanoseconds(utc.rest_ns);
    constexpr std::int64_t week = GpsTime::nanoseconds_per_week;
    std::int64_t off =
        (std::int64_t{epoch.time_of_week_ms} * 1'000'000 - shown.nanoseconds_of_week()) % week;
    if (off > week / 2) off -= week;
    if (off < -week / 2) off += week;
    const std::int64_t seconds = whole_seconds(off);
    constexpr std::int64_t most_leap_seconds = 40;
    if (seconds == 0 || std::abs(seconds) > most_leap_seconds) return shown;
    const GpsTime counted = shown.plus_nanoseconds(seconds * GpsTime::nanoseconds_per_second);
    const auto then = leap_seconds_at(shown);
    if (const auto later = then ? in_true_week(counted, *then + seconds) : std::nullopt)
        return later;
    ++tally_.other_second;
    return counted;
}

std::optional<GpsTime> RowMaker::in_true_week(GpsTime shown, std::int64_t leap_seconds) {
    const std::optional<GpsTime> later = after_rollovers(shown, leap_seconds);
    if (later) ++tally_.rolled_over;
    return later;
}

void RowMaker::set_place(Observation& row, const Epoch& epoch) {
    const RecordPlace place = epoch.place();
    if (epoch.has(Part::hpposllh) && !bit(epoch[Part::hpposllh], 3, 0)) {
        const std::string_view hp = epoch[Part::hpposllh];
        set_position(row, checked_geodetic(high_precision_position(hp), recording_, place));
        set_position_accuracy(row, hp, 28, 1e4);
        ++tally_.high_precision;
        return;
    }
    const Part source = epoch.position();
    if (source == Part::hpposllh)
        throw Failure(place_in(recording_, place),
                      "the receiver says that its NAV-HPPOSLLH is invalid", "Record NAV-PVT, too");
    const std::string_view payload = epoch[source];
    if (source == Part::sol) {
        set_position(row, checked_ecef(centimetres_at(payload, 12), recording_, place));
        // Of all three coordinates together.
        const double sigma_m = accuracy(payload, 24, 1e2) / std::sqrt(3.0);
        set_radial_accuracy(row, sigma_m * std::sqrt(2.0));
        if (sigma_m > 0.0) row.sigma_up_m = sigma_m;
        ++tally_.of_solution;
        ++tally_.standard_precision;
        return;
    }
    const bool pvt = source == Part::pvt;
    set_position(row, checked_geodetic(position_at(payload, pvt ? 24 : 4), recording_, place));
    set_position_accuracy(row, payload, pvt ? 40 : 20, 1e3);
    ++tally_.standard_precision;
}

std::optional<TimedRow> RowMaker::row(const Epoch& epoch) {
    const std::optional<GpsTime> when = instant(epoch);
    if (!when) return std::nullopt;
    TimedRow timed;
    timed.instant = *when;
    Observation& row = timed.observation;
    if (epoch.has(Part::status)) status_ = epoch.parts[static_cast<std::size_t>(Part::status)];
    row.fix = fix_of(epoch);
    if (row.fix == FixType::unknown) row.fix = fix_by_status(epoch);
    if (epoch.has(Part::pvt))
        row.satellites = number<std::uint8_t>(epoch[Part::pvt], 23);
    else if (epoch.has(Part::sol))
        row.satellites = number<std::uint8_t>(epoch[Part::sol], 47);
    if (row.fix == FixType::none) return timed;
    set_place(row, epoch);
    if (epoch.has(Part::pvt))
        set_velocity_of(row, epoch[Part::pvt], 48, 68, 1e3);
    else if (epoch.has(Part::velned))
        set_velocity_of(row, epoch[Part::velned], 4, 28, 1e2);
    else if (epoch.has(Part::sol))
        set_velocity_of_solution(row, epoch[Part::sol]);
    if (epoch.has(Part::cov)) set_covariances(row, epoch[Part::cov]);
    const std::uint8_t type = solution_type(epoch);
    if (type == two_dimensional) ++tally_.in_plane;
    if (type == with_dead_reckoning) ++tally_.with_dead_reckoning;
    return timed;
}

}  // namespace runcert::ubx
