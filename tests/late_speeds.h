#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.h"

// A board that sails out and back, recorded with speeds that are not of the moments of their
// positions, in the formats that devices write.

namespace runcert::late_speeds {

/// Legs towards east and west, up to full speed and down again, and slow half circles between them.
struct Board {
    double leg_s = 60.0, leg_m_s = 12.0;
    double turn_s = 25.0, turn_m_s = 2.0;
    double acceleration_m_s2 = 2.0;
    double longer_s = 0.0;  ///< each leg than the one before
    double sails_s = 315.0;

    struct Motion {
        double east_m = 0.0, north_m = 0.0, speed_m_s = 0.0, course_deg = 0.0;
    };

    double ramp_s() const { return (leg_m_s - turn_m_s) / acceleration_m_s2; }
    /// So long after a leg's beginning, or before its end, while the speed changes.
    double on_ramp_m(double time_s) const {
        return time_s * (turn_m_s + 0.5 * acceleration_m_s2 * time_s);
    }
    double on_leg_m(double time_s, double this_leg_s) const {
        const double full_s = std::clamp(time_s - ramp_s(), 0.0, this_leg_s - 2.0 * ramp_s());
        const double slows_s = std::max(0.0, time_s - this_leg_s + ramp_s());
        return on_ramp_m(std::min(time_s, ramp_s())) + leg_m_s * full_s + on_ramp_m(ramp_s()) -
               on_ramp_m(ramp_s() - slows_s);
    }

    /// Before it begins and after it has sailed it stands.
    Motion at(double time_s) const {
        Motion motion;
        double direction = 1.0, left_s = std::min(time_s, sails_s), this_leg_s = leg_s;
        const double radius_m = turn_m_s * turn_s / std::numbers::pi;
        while (left_s > 0.0) {
            const double on_leg_s = std::min(left_s, this_leg_s);
            motion.east_m += direction * on_leg_m(on_leg_s, this_leg_s);
            motion.speed_m_s = std::min(
                leg_m_s, turn_m_s + acceleration_m_s2 * std::min(on_leg_s, this_leg_s - on_leg_s));
            motion.course_deg = direction > 0.0 ? 90.0 : 270.0;
            left_s -= on_leg_s;
            if (left_s <= 0.0) break;
            const double in_turn_s = std::min(left_s, turn_s);
            const double angle = std::numbers::pi * in_turn_s / turn_s;
            motion.east_m += direction * radius_m * std::sin(angle);
            motion.north_m += radius_m * (1.0 - std::cos(angle));
            motion.speed_m_s = turn_m_s;
            motion.course_deg = std::fmod(
                360.0 + 90.0 -
                    180.0 / std::numbers::pi * (direction > 0.0 ? angle : std::numbers::pi - angle),
                360.0);
            left_s -= in_turn_s;
            direction = -direction;
            this_leg_s += longer_s;
        }
        if (time_s <= 0.0 || time_s > sails_s) motion.speed_m_s = 0.0;
        return motion;
    }
};

struct Row {
    double time_s = 0.0;
    double latitude_deg = 0.0, longitude_deg = 0.0;
    double speed_m_s = 0.0, course_deg = 0.0;
};

struct Recorded {
    Board board = {};
    double duration_s = 375.0;
    double interval_s = 1.0;
    /// By how much a speed is behind the position beside it, at each time.
    std::function<double(double)> delay_s = [](double) { return 0.0; };
    double noise_m = 0.1;
    double noise_m_s = 0.05;
    double factor = 1.0;  ///< of the speeds
    std::uint64_t seed = 1;

    std::vector<Row> rows() const {
        constexpr double metres_per_degree = 111'320.0;
        constexpr double latitude_deg = 52.1, longitude_deg = 5.1;
        RandomGenerator random(seed);
        std::vector<Row> rows;
        for (int k = 0; interval_s * k < duration_s; ++k) {
            const double time_s = interval_s * k;
            const Board::Motion here = board.at(time_s);
            const Board::Motion then = board.at(time_s - delay_s(time_s));
            const double scale =
                metres_per_degree * std::cos(latitude_deg * std::numbers::pi / 180.0);
            rows.push_back(
                {.time_s = time_s,
                 .latitude_deg =
                     latitude_deg + (here.north_m + noise_m * random.normal()) / metres_per_degree,
                 .longitude_deg = longitude_deg + (here.east_m + noise_m * random.normal()) / scale,
                 .speed_m_s = std::max(0.0, factor * then.speed_m_s + noise_m_s * random.normal()),
                 .course_deg = then.course_deg});
        }
        return rows;
    }
};

/// A delay that does not change.
inline std::function<double(double)> always(double delay_s) {
    return [delay_s](double) { return delay_s; };
}

/// "10:03:43.200" so many seconds after ten.
inline std::string clock_text(double time_s, const char* form = "{:02}:{:02}:{:06.3f}") {
    const double seconds = 36'000.0 + time_s;
    const auto minutes = static_cast<int>(std::floor(seconds / 60.0 + 1e-9));
    return fmt::format(fmt::runtime(form), minutes / 60, minutes % 60,
                       std::max(0.0, seconds - 60.0 * minutes));
}

inline std::string gpx(const std::vector<Row>& rows) {
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"watch\" "
        "xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n";
    for (const Row& row : rows)
        text += fmt::format(
            "<trkpt lat=\"{:.7f}\" lon=\"{:.7f}\"><ele>0.0</ele><time>2026-03-14T{}Z</time>"
            "<extensions><speed>{:.3f}</speed></extensions></trkpt>\n",
            row.latitude_deg, row.longitude_deg, clock_text(row.time_s), row.speed_m_s);
    return text + "</trkseg></trk></gpx>\n";
}

inline std::string csv(const std::vector<Row>& rows) {
    std::string text = "time_s,lat,lon,speed\n";
    for (const Row& row : rows)
        text += fmt::format("{:.3f},{:.7f},{:.7f},{:.3f}\n", row.time_s, row.latitude_deg,
                            row.longitude_deg, row.speed_m_s);
    return text;
}

/// With courses.
inline std::string nmea(const std::vector<Row>& rows) {
    const auto angle = [](double degrees, int digits) {
        const double whole = std::floor(degrees);
        return fmt::format("{:0{}.0f}{:011.8f}", whole, digits, 60.0 * (degrees - whole));
    };
    std::string text;
    for (const Row& row : rows) {
        const std::string body = fmt::format(
            "GPRMC,{},A,{},N,{},E,{:.3f},{:.2f},140326,,,A",
            clock_text(row.time_s, "{:02}{:02}{:06.3f}"), angle(row.latitude_deg, 2),
            angle(row.longitude_deg, 3), row.speed_m_s / 1852.0 * 3600.0, row.course_deg);
        unsigned sum = 0;
        for (const char byte : body)
            sum ^= static_cast<unsigned char>(byte);
        text += fmt::format("${}*{:02X}\r\n", body, sum);
    }
    return text;
}

/// With components and their accuracy.
inline std::string flysight(const std::vector<Row>& rows) {
    std::string text =
        "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,heading,cAcc,gpsFix,numSV\r\n"
        ",(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),(deg),(deg),,\r\n";
    for (const Row& row : rows) {
        const double course = row.course_deg * std::numbers::pi / 180.0;
        text += fmt::format(
            "2026-03-14T{}Z,{:.7f},{:.7f},0.000,{:.2f},{:.2f},0.00,0.500,1.000,0.10,0.00000,"
            "180.00000,3,12\r\n",
            clock_text(row.time_s), row.latitude_deg, row.longitude_deg,
            row.speed_m_s * std::cos(course), row.speed_m_s * std::sin(course));
    }
    return text;
}

/// Records of a FIT activity: whole seconds, a speed without a course. `crc16` is the protocol's.
template <class Crc16>
std::string fit(const std::vector<Row>& rows, const Crc16& crc16) {
    const auto number = [](auto value, std::size_t size) {
        std::string bytes;
        for (std::size_t i = 0; i < size; ++i)
            bytes += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xff);
        return bytes;
    };
    constexpr std::uint32_t ten_o_clock = 1'142'416'800;  // of 2026-03-14, from 1989-12-31
    constexpr double semicircles = 2147483648.0 / 180.0;
    // Local type 0: time stamp, latitude, longitude, altitude, speed.
    std::string records("\x40\0\0\x14\0\x05\xfd\x04\0\0\x04\0\x01\x04\0\x02\x02\0\x06\x02\0", 21);
    for (const Row& row : rows)
        records += std::string(1, '\0') + number(ten_o_clock + std::llround(row.time_s), 4) +
                   number(std::llround(row.latitude_deg * semicircles), 4) +
                   number(std::llround(row.longitude_deg * semicircles), 4) + number(2500, 2) +
                   number(std::llround(row.speed_m_s * 1000.0), 2);
    const std::string bytes = std::string("\x0e\x10", 2) + number(2134, 2) +
                              number(records.size(), 4) + ".FIT" + number(0, 2) + records;
    return bytes + number(crc16(bytes), 2);
}

}  // namespace runcert::late_speeds
