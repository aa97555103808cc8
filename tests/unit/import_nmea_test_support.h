#pragma once

#include <fmt/format.h>

#include "import_test_support.h"

namespace runcert::nmea_test {

using namespace import_test;

/// "$body*hh", with its checksum.
inline std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body)
        sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

inline std::string gga(const std::string& time, const std::string& quality = "1") {
    return sentence("GPGGA," + time + ",4530.0000000,N,00915.0000000,E," + quality +
                    ",10,0.9,120.5,M,47.25,M,1.5,0001");
}
inline std::string rmc(const std::string& time, const std::string& date) {
    return sentence("GNRMC," + time + ",A,4530.0000000,N,00915.0000000,E,10.00,90.0," + date +
                    ",,,A");
}

inline Observations read_nmea(const std::string& text) {
    return import_text(pos_receiver(), text, "log.nmea");
}

inline std::string utc_of(const Observations& read, std::size_t row, int decimals = 3) {
    return to_utc_iso(read.facts.first_epoch->plus_nanoseconds(read.rows.at(row).time.nanoseconds),
                      decimals);
}

}  // namespace runcert::nmea_test
