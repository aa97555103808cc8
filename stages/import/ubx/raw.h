#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "satellites/ephemeris.h"
#include "stages/import/measured_epoch.h"
#include "stages/import/osnma/inav_page.h"
#include "stages/import/recording.h"

namespace runcert::ubx {

/// A page that a satellite of Galileo sent on E1-B; none where it is damaged.
struct E1Page {
    std::uint8_t satellite = 0;
    std::optional<InavPage> page;
};

/// The page in the payload of an RXM-SFRBX message; empty for another signal.
std::optional<E1Page> e1_page(std::string_view payload);

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

/// The raw measurements of a recording, and the ephemerides of its navigation messages.
struct RawFile {
    MeasurementFacts facts;
    std::vector<Ephemeris> ephemerides;
};

/// Whether the beginning of a recording has an RXM-RAWX message.
bool has_raw(std::string_view bytes);

/// Goes through RXM-RAWX epoch by epoch, and collects ephemerides of RXM-SFRBX (GPS LNAV, Galileo
/// I/NAV): u-blox "F9 HPG interface description" (UBX-22008968), sections 3.17.9 and 3.17.10,
/// [IS-GPS-200] 20.3.3, [GAL-ICD] 4.3. Other systems and messages are counted and set aside.
///
/// A phase whose lock time went down, or is shorter than the step, has lost its lock; one whose
/// half cycle is not resolved says so. Failure where there are no measurements, and where most
/// records cannot be read.
RawFile read_raw(const RecordingBytes& recording, const TakeMeasurements& take);

}  // namespace runcert::ubx
