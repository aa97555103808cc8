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

/// A craft that goes north at 64 m/s after a start, recorded ten times a second for a minute with
/// 1 cm of noise; the k-th stamp is `stamps_s[k]` after 2026-03-14T03:20:00 UTC.
struct RecordedRun {
    static constexpr int epochs = 600;
    std::vector<double> stamps_s;

    /// Stamps that are `step_s` apart.
    static RecordedRun every(double step_s) {
        RecordedRun run;
        for (int k = 0; k < epochs; ++k)
            run.stamps_s.push_back(k * step_s);
        return run;
    }

    struct Place {
        double latitude_deg, longitude_deg, height_m, north_m_s;
    };
    Place place(int k) const {
        static const std::vector<Place> all = [] {
            const LocalFrame frame({.latitude = Angle::from_degrees(-31.6),
                                    .longitude = Angle::from_degrees(136.0),
                                    .height_m = 110.0});
            RandomGenerator random(5);
            std::vector<Place> places;
            double north_m = 0.0;
            for (int i = 0; i < epochs; ++i) {
                const double speed_m_s = 64.0 / (1.0 + std::exp(-0.3 * (0.1 * i - 20.0)));
                north_m += 0.1 * speed_m_s;
                const Geodetic at = frame.geodetic_from_enu(
                    {{0.01 * random.normal(), north_m + 0.01 * random.normal(),
                      0.02 * random.normal()}});
                places.push_back(
                    {at.latitude.degrees(), at.longitude.degrees(), at.height_m, speed_m_s});
            }
            return places;
        }();
        return all[static_cast<std::size_t>(k)];
    }
    std::int64_t ms(int k) const {
        return std::llround(stamps_s[static_cast<std::size_t>(k)] * 1e3);
    }
    /// hh, mm, ss.sss of UTC.
    std::string clock(int k, int decimals, const char* between = "") const {
        const std::int64_t of_day = ((3 * 60 + 20) * 60) * 1000 + ms(k);
        return fmt::format("{:02}{}{:02}{}{:0{}.{}f}", of_day / 3'600'000, between,
                           of_day / 60'000 % 60, between,
                           static_cast<double>(of_day % 60'000) * 1e-3, decimals + 3, decimals);
    }

    std::string pos(const std::string& header = {}) const {
        std::string text = header +
                           "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) "
                           "sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n";
        for (int k = 0; k < epochs; ++k) {
            const Place at = place(k);
            text +=
                fmt::format("2026/03/14 {} {:.9f} {:.9f} {:.4f} 1 20 0.01 0.01 0.02 0 0 0 0 50\n",
                            clock(k, 3, ":"), at.latitude_deg, at.longitude_deg, at.height_m);
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
        for (int k = 0; k < epochs; ++k) {
            const Place at = place(k);
            const std::string where =
                fmt::format("{},S,{},E", minutes(at.latitude_deg, 2), minutes(at.longitude_deg, 3));
            text += sentence(fmt::format("GNGGA,{},{},{},12,0.8,{:.3f},M,0.0,M,,", clock(k, 3),
                                         where, quality, at.height_m));
            text += sentence(fmt::format("GNRMC,{},A,{},{:.3f},0.0,140326,,,{}", clock(k, 3), where,
                                         at.north_m_s * 3600 / 1852, mode));
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
        for (int k = 0; k < epochs; ++k) {
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
        for (int k = 0; k < epochs; ++k) {
            const Place at = place(k);
            text += fmt::format(
                "$GNSS,2026-03-14T{}Z,{:.8f},{:.8f},{:.3f},{:.3f},0.0,0.0,0.02,0.04,0.05,12\n",
                clock(k, 3, ":"), at.latitude_deg, at.longitude_deg, at.height_m, at.north_m_s);
        }
        return text;
    }

    /// NAV-PVT, fixed.
    std::string ubx() const {
        std::string text;
        for (int k = 0; k < epochs; ++k) {
            const Place at = place(k);
            const std::int64_t of_day = ((3 * 60 + 20) * 60) * 1000 + ms(k);
            const std::int64_t second = (of_day + 500) / 1000;
            std::string payload(92, '\0');
            put(payload, 0, (6 * 86'400'000LL + of_day + 18'000) % 604'800'000LL, 4);
            put(payload, 4, 2026, 2);
            put(payload, 6, 3, 1);
            put(payload, 7, 14, 1);
            put(payload, 8, second / 3600, 1);
            put(payload, 9, second / 60 % 60, 1);
            put(payload, 10, second % 60, 1);
            put(payload, 11, 0x37, 1);
            put(payload, 16, (of_day - second * 1000) * 1'000'000, 4);
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
        for (int k = 0; k < epochs; ++k) {
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

  private:
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
