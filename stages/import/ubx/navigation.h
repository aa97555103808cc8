#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "satellites/ephemeris.h"

namespace runcert::ubx {

/// Puts ephemerides together from RXM-SFRBX messages: GPS LNAV (subframes 1 to 3 of one issue,
/// [IS-GPS-200] 20.3.3) and Galileo I/NAV (words 1 to 4 of one issue, 5 for health and group delay,
/// [GAL-ICD] 4.3).
class NavigationCollector {
  public:
    /// Takes in the payload of a message whose frame begins at `byte`; `near` is an instant within
    /// half a week of it. False where it is of another system or signal, or damaged.
    bool take(std::string_view payload, std::int64_t byte, GpsTime near);

    /// The whole ephemerides, in the order in which they were completed, each once.
    const std::vector<Ephemeris>& ephemerides() const { return whole_; }

  private:
    /// The pages of a satellite's present ephemeris, as they come.
    struct Pages {
        std::array<std::vector<std::uint8_t>, 6> page;  ///< bytes, most significant bit first
        std::int64_t byte = 0;                          ///< of the first of them
    };
    bool take_lnav(Satellite satellite, std::string_view payload, std::int64_t byte, GpsTime near);
    bool take_inav(Satellite satellite, std::string_view payload, std::int64_t byte, GpsTime near);
    void add(Ephemeris ephemeris);

    std::map<Satellite, Pages> pages_;
    std::vector<Ephemeris> whole_;
};

}  // namespace runcert::ubx
