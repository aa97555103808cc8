#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "core/gps_time.h"
#include "core/random.h"
#include "core/text.h"

// One run, as files of the formats whose stamps are the satellites' time.

namespace runcert::chain {

/// A craft that goes north, recorded with 1 cm of noise; the k-th stamp is `stamps_s[k]` after
/// 2026-03-14T03:20:00 UTC.
struct RecordedRun {
    static constexpr int epochs = 600;
    struct Place {
        double latitude_deg, longitude_deg, height_m, north_m_s;
    };
    std::vector<double> stamps_s;
    std::vector<Place> places;

    /// At 64 m/s after a start, a minute at ten a second; stamps that are `step_s` apart.
    static RecordedRun every(double step_s) {
        static const std::vector<Place> all = along(
            epochs, 0.1, [](double t_s) { return 64.0 / (1.0 + std::exp(-0.3 * (t_s - 20.0))); });
        RecordedRun run;
        run.places = all;
        for (int k = 0; k < epochs; ++k)
            run.stamps_s.push_back(k * step_s);
        return run;
    }

    /// So many places that long apart (s), with the speed (m/s) that it has at each time.
    template <class Speed>
    static std::vector<Place> along(int count, double interval_s, const Speed& speed) {
        const LocalFrame frame({.latitude = Angle::from_degrees(-31.6),
                                .longitude = Angle::from_degrees(136.0),
                                .height_m = 110.0});
        RandomGenerator random(5);
        std::vector<Place> places;
        double north_m = 0.0;
        for (int i = 0; i < count; ++i) {
            const double speed_m_s = speed(interval_s * i);
            north_m += interval_s * speed(interval_s * (i - 0.5));
            const Geodetic at = frame.geodetic_from_enu(
                {{0.01 * random.normal(), north_m + 0.01 * random.normal(), 0.0}});
            // On the level of the ellipsoid, not in the plane.
            const double height_m = 110.0 + 0.02 * random.normal();
            places.push_back({at.latitude.degrees(), at.longitude.degrees(), height_m, speed_m_s});
        }
        return places;
    }

    int size() const { return static_cast<int>(stamps_s.size()); }
    const Place& place(int k) const { return places[static_cast<std::size_t>(k)]; }
    std::int64_t ms(int k) const {
        return std::llround(stamps_s[static_cast<std::size_t>(k)] * 1e3);
    }
    /// In UTC, without a leap second: there is none between.
    CalendarTime utc(int k) const {
        return GpsTime::from_calendar({2026, 3, 14, 3, 20, 0, 0})
            .plus_nanoseconds(ms(k) * 1'000'000)
            .calendar();
    }
    /// hh, mm, ss.sss of UTC.
    std::string clock(int k, int decimals, const char* between = "") const {
        const CalendarTime at = utc(k);
        return fmt::format("{:02}{}{:02}{}{:0{}.{}f}", at.hour, between, at.minute, between,
                           at.second + static_cast<double>(at.nanosecond) * 1e-9,
                           decimals > 0 ? decimals + 3 : 2, decimals);
    }
    std::string date(int k, const char* between) const {
        const CalendarTime at = utc(k);
        return fmt::format("{:04}{}{:02}{}{:02}", at.year, between, at.month, between, at.day);
    }
    std::string ddmmyy(int k) const {
        const CalendarTime at = utc(k);
        return fmt::format("{:02}{:02}{:02}", at.day, at.month, at.year % 100);
    }

    std::string pos(const std::string& header = {}) const {
        std::string text = header +
                           "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) "
                           "sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n";
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            text += fmt::format("{} {} {:.9f} {:.9f} {:.4f} 1 20 0.01 0.01 0.02 0 0 0 0 50\n",
                                date(k, "/"), clock(k, 3, ":"), at.latitude_deg, at.longitude_deg,
                                at.height_m);
        }
        return text;
    }

    std::string nmea(char quality = '4', char mode = 'R') const {
        const auto sentence = [](const std::string& body) {
            unsigned sum = 0;
            for (const char c : body)
                sum ^= static_cast<unsigned char>(c);
            return fmt::format("${}*{:02X}\r\n", body, sum);
        };
        const auto minutes = [](double degrees, int width) {
            const double all = std::abs(degrees);
            return fmt::format("{:0{}}{:010.7f}", static_cast<int>(all), width,
                               (all - std::floor(all)) * 60.0);
        };
        std::string text;
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            const std::string where =
                fmt::format("{},S,{},E", minutes(at.latitude_deg, 2), minutes(at.longitude_deg, 3));
            text += sentence(fmt::format("GNGGA,{},{},{},12,0.8,{:.3f},M,0.0,M,,", clock(k, 3),
                                         where, quality, at.height_m));
            text += sentence(fmt::format("GNRMC,{},A,{},{:.3f},0.0,{},,,{}", clock(k, 3), where,
                                         at.north_m_s * 3600 / 1852, ddmmyy(k), mode));
        }
        return text;
    }

    std::string vbo(const std::string& comment = "VBox II Version 4.5a") const {
        std::string text =
            "File created on 14/03/2026 at 03:20:00\r\n\r\n[header]\r\nsatellites\r\ntime\r\n"
            "latitude\r\nlongitude\r\nvelocity kmh\r\nheading\r\nheight\r\n\r\n[comments]\r\n" +
            comment +
            "\r\n\r\n[column names]\r\nsats time lat long velocity heading height\r\n\r\n"
            "[data]\r\n";
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            text += fmt::format("012 {} {:+013.8f} {:+014.8f} {:07.3f} 000.00 {:+09.3f}\r\n",
                                clock(k, 3), at.latitude_deg * 60.0, -at.longitude_deg * 60.0,
                                at.north_m_s * 3.6, at.height_m);
        }
        return text;
    }

    std::string flysight(const std::string& firmware = "v2024.08.07") const {
        std::string text = "$FLYS,1\n$VAR,FIRMWARE_VER," + firmware +
                           "\n$COL,GNSS,time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,numSV\n"
                           "$UNIT,GNSS,,deg,deg,m,m/s,m/s,m/s,m,m,m/s,\n$DATA\n";
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            text +=
                fmt::format("$GNSS,{}T{}Z,{:.8f},{:.8f},{:.3f},{:.3f},0.0,0.0,0.02,0.04,0.05,12\n",
                            date(k, "-"), clock(k, 3, ":"), at.latitude_deg, at.longitude_deg,
                            at.height_m, at.north_m_s);
        }
        return text;
    }

    /// NAV-PVT, fixed.
    std::string ubx() const {
        std::string text;
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            const GpsTime gps = gps_from_utc(utc(k));
            const CalendarTime nearest =
                GpsTime::from_calendar(utc(k)).plus_nanoseconds(500'000'000).calendar();
            const std::int64_t in_week_ms = gps.nanoseconds() / 1'000'000 % 604'800'000LL;
            std::string payload(92, '\0');
            put(payload, 0, in_week_ms, 4);
            put(payload, 4, nearest.year, 2);
            put(payload, 6, nearest.month, 1);
            put(payload, 7, nearest.day, 1);
            put(payload, 8, nearest.hour, 1);
            put(payload, 9, nearest.minute, 1);
            put(payload, 10, nearest.second, 1);
            put(payload, 11, 0x37, 1);
            const std::int64_t from_epoch_ms =
                GpsTime::from_calendar(utc(k)).nanoseconds() / 1'000'000;
            put(payload, 16, (from_epoch_ms - (from_epoch_ms + 500) / 1000 * 1000) * 1'000'000, 4);
            put(payload, 20, 3, 1);
            put(payload, 21, 0x83, 1);
            put(payload, 23, 14, 1);
            put(payload, 24, std::llround(at.longitude_deg * 1e7), 4);
            put(payload, 28, std::llround(at.latitude_deg * 1e7), 4);
            put(payload, 32, std::llround(at.height_m * 1e3), 4);
            put(payload, 40, 10, 4);
            put(payload, 44, 20, 4);
            put(payload, 48, std::llround(at.north_m_s * 1e3), 4);
            put(payload, 68, 50, 4);
            std::string body{'\x01', '\x07', '\x5c', '\0'};
            body += payload;
            text += "\xb5\x62" + body + checksum(body, std::string::npos);
        }
        return text;
    }

    std::string oao() const {
        std::string text = framed(std::string{'\xd0', '\x0a', 0, 0, '\x77', 1}, 512);
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            constexpr std::int64_t first_unix_ms = 1'773'458'400'000;  // 2026-03-14T03:20:00Z
            std::string frame(52, '\0');
            put(frame, 0, ms(k) % 1000 == 0 ? 0x0AD4 : 0x0AD5, 2);
            put(frame, 4, std::llround(at.latitude_deg * 1e7), 4);
            put(frame, 8, std::llround(at.longitude_deg * 1e7), 4);
            put(frame, 12, std::llround(at.height_m * 1e3), 4);
            put(frame, 16, std::llround(at.north_m_s * 1e3), 4);
            put(frame, 24, first_unix_ms + ms(k), 8);
            put(frame, 32, 3, 1);
            put(frame, 33, 12, 1);
            put(frame, 34, 50, 4);
            put(frame, 38, 10, 4);
            put(frame, 42, 20, 4);
            text += framed(frame, 52);
        }
        return text;
    }

    /// With the attempt's columns: {time: time, latitude: lat, longitude: lon, height: h, speed:
    /// v}.
    std::string csv() const {
        std::string text = "time,lat,lon,h,v\n";
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            text +=
                fmt::format("{}T{}Z,{:.9f},{:.9f},{:.3f},{:.3f}\n", date(k, "-"), clock(k, 3, ":"),
                            at.latitude_deg, at.longitude_deg, at.height_m, at.north_m_s);
        }
        return text;
    }

    std::string gpx() const {
        std::string text =
            "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"logger\" "
            "xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n";
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            text += fmt::format(
                "<trkpt lat=\"{:.9f}\" "
                "lon=\"{:.9f}\"><ele>{:.3f}</ele><time>{}T{}Z</time></trkpt>\n",
                at.latitude_deg, at.longitude_deg, at.height_m, date(k, "-"), clock(k, 3, ":"));
        }
        return text + "</trkseg></trk></gpx>\n";
    }

    /// Whole seconds; a new date before the record that is the first of its day.
    std::string igc() const {
        std::string text = "AXXX001\r\nI023637LAD3839LOD\r\n", day;
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            if (ddmmyy(k) != day) text += "HFDTE" + (day = ddmmyy(k)) + "\r\n";
            // Hundred-thousandths of a minute, the last two digits at the end of the record.
            const auto all_of = [](double degrees) {
                return std::llround(std::abs(degrees) * 6'000'000.0);
            };
            const auto minutes = [](long long all, int width) {
                return fmt::format("{:0{}}{:05}", all / 6'000'000, width, all % 6'000'000 / 100);
            };
            const auto latitude = all_of(at.latitude_deg), longitude = all_of(at.longitude_deg);
            text += fmt::format("B{}{}S{}EA{:05.0f}{:05.0f}{:02}{:02}\r\n", clock(k, 0),
                                minutes(latitude, 2), minutes(longitude, 3), at.height_m,
                                at.height_m, latitude % 100, longitude % 100);
        }
        return text;
    }

    /// Records with time, place, height and speed; whole seconds.
    std::string fit() const {
        std::string records{'\x40', '\0', '\0', '\x14', '\0', '\x05'};
        for (const auto& [name, size] : {std::pair{253, 4}, {0, 4}, {1, 4}, {2, 2}, {6, 2}})
            records += {static_cast<char>(name), static_cast<char>(size), '\0'};
        for (int k = 0; k < size(); ++k) {
            const Place at = place(k);
            std::string record(17, '\0');
            constexpr std::int64_t fit_epoch_s = 631'065'600, unix_s = 1'773'458'400;
            put(record, 1, unix_s - fit_epoch_s + ms(k) / 1000, 4);
            put(record, 5, std::llround(at.latitude_deg / 180.0 * 2147483648.0), 4);
            put(record, 9, std::llround(at.longitude_deg / 180.0 * 2147483648.0), 4);
            put(record, 13, std::llround((at.height_m + 500.0) * 5.0), 2);
            put(record, 15, std::llround(at.north_m_s * 1e3), 2);
            records += record;
        }
        std::string bytes("\x0e\x10\x56\x08....FIT..", 14);
        put(bytes, 4, static_cast<std::int64_t>(records.size()), 4);
        bytes.replace(8, 4, ".FIT");
        put(bytes, 12, 0, 2);
        bytes += records;
        std::string sum(2, '\0');
        put(sum, 0, crc16(bytes), 2);
        return bytes + sum;
    }

  private:
    static std::int64_t crc16(const std::string& bytes) {
        std::uint32_t crc = 0;
        for (const char c : bytes) {
            crc ^= static_cast<unsigned char>(c);
            for (int bit = 0; bit < 8; ++bit)
                crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
        }
        return crc;
    }
    static void put(std::string& bytes, std::size_t at, std::int64_t value, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i)
            bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xff);
    }
    /// Fletcher's, but for the two bytes at `but`.
    static std::string checksum(const std::string& bytes, std::size_t but) {
        unsigned a = 0, b = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            if (but != std::string::npos && (i == but || i == but + 1)) continue;
            a = (a + static_cast<unsigned char>(bytes[i])) & 0xff;
            b = (b + a) & 0xff;
        }
        return {static_cast<char>(a), static_cast<char>(b)};
    }
    static std::string framed(std::string frame, std::size_t length) {
        frame.resize(length, '\0');
        return frame.replace(2, 2, checksum(frame, 2));
    }
};

}  // namespace runcert::chain
