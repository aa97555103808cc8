#pragma once

#include <bit>
#include <string>

#include "import_test_support.h"

namespace runcert::ubx_test {

using namespace import_test;

/// A payload of zeros into which numbers are put, little endian.
class Payload {
  public:
    explicit Payload(std::size_t size) : bytes_(size, '\0') {}
    Payload& put(std::size_t at, std::int64_t value, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i)
            bytes_.at(at + i) = static_cast<char>(value >> (8 * i) & 0xff);
        return *this;
    }
    Payload& real(std::size_t at, float value) {
        return put(at, std::bit_cast<std::int32_t>(value), 4);
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

inline std::string frame(int message_class, int id, const std::string& payload) {
    std::string body{static_cast<char>(message_class), static_cast<char>(id),
                     static_cast<char>(payload.size() & 0xff),
                     static_cast<char>(payload.size() >> 8)};
    body += payload;
    unsigned a = 0, b = 0;
    for (const char c : body) {
        a = (a + static_cast<unsigned char>(c)) & 0xff;
        b = (b + a) & 0xff;
    }
    return "\xb5\x62" + body + static_cast<char>(a) + static_cast<char>(b);
}

// 2023-07-11 06:04:30 UTC is a Tuesday: 2 days, 6 h 4 min 30 s and 18 leap seconds into the week.
constexpr std::int64_t first_tow_ms = ((2 * 24 + 6) * 60 + 4) * 60'000 + 48'000;

/// A NAV-PVT of 2023-07-11T06:04:30 UTC plus `ms`, whose clock is 400 ns behind: 3D, satellites
/// alone.
inline Payload pvt(int ms = 0, std::size_t size = 92) {
    Payload payload(size);
    payload.put(0, first_tow_ms + ms, 4).put(4, 2023, 2).put(6, 7, 1).put(7, 11, 1).put(8, 6, 1);
    // The second is the nearest, and the rest to it may be negative.
    payload.put(9, 4, 1).put(10, 30 + (ms + 500) / 1000, 1).put(11, 0x37, 1);
    payload.put(16, (ms - (ms + 500) / 1000 * 1000) * 1'000'000 - 400, 4);
    payload.put(20, 3, 1).put(21, 0x01, 1).put(23, 14, 1);
    payload.put(24, 92'500'000, 4).put(28, 455'000'000 + ms, 4).put(32, 167'750, 4);
    payload.put(40, 1'500, 4).put(44, 2'000, 4);
    payload.put(48, 3'000, 4).put(52, -4'000, 4).put(56, 500, 4).put(68, 300, 4);
    return payload;
}
inline std::string pvt_frame(int ms = 0) {
    return frame(0x01, 0x07, pvt(ms).bytes());
}

inline Payload hpposllh(int ms = 0) {
    return Payload(36)
        .put(4, first_tow_ms + ms, 4)
        .put(8, 92'500'001, 4)
        .put(12, 455'000'002, 4)
        .put(16, 167'751, 4)
        .put(24, -37, 1)
        .put(25, 42, 1)
        .put(26, -9, 1)
        .put(28, 141, 4)
        .put(32, 255, 4);
}

inline Payload cov(int ms = 0) {
    Payload payload(64);
    payload.put(0, first_tow_ms + ms, 4).put(5, 1, 1).put(6, 1, 1);
    const float position[] = {4.0F, 1.0F, -0.5F, 9.0F, 2.0F, 16.0F};  // NN NE ND EE ED DD
    for (std::size_t i = 0; i < 6; ++i)
        payload.real(16 + 4 * i, position[i]).real(40 + 4 * i, position[i] / 100.0F);
    return payload;
}

inline Observations read_ubx(const std::string& bytes) {
    return import_text(pos_receiver(), bytes, "log.ubx");
}

inline GpsTime instant(const Observations& read, std::size_t row) {
    return read.facts.first_epoch->plus_nanoseconds(read.rows.at(row).time.nanoseconds);
}

}  // namespace runcert::ubx_test
