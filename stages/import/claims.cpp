#include "stages/import/claims.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace runcert {
namespace {

/// What the time stamps of a format are.
struct TimeOrigin {
    std::string_view format;
    bool of_satellites = false;
    std::string_view words;
};

constexpr std::array origins{
    TimeOrigin{"rtklib-pos", true, "GPS time of the receiver's measurements, as RTKLIB solved it"},
    TimeOrigin{"rinex", true, "GPS time of the receiver's measurements, as RTKLIB solved it"},
    TimeOrigin{"nmea", true, "UTC of the receiver's position sentences"},
    TimeOrigin{"ubx", true, "UTC of the receiver's navigation solutions"},
    TimeOrigin{"vbo", true, "UTC of the receiver, the file's time channel"},
    TimeOrigin{"flysight", true, "UTC of the receiver's navigation solutions"},
    TimeOrigin{"oao", true, "UTC of the receiver's navigation solutions"},
    TimeOrigin{"sbp", true, "UTC of the receiver's navigation solutions"},
    TimeOrigin{"sbn", true, "GPS time of the receiver's navigation solutions"},
    TimeOrigin{"igc", true, "UTC of the flight recorder's satellite positions"},
    TimeOrigin{"gpx", false, "times of the file's points, whose clock the format does not say"},
    TimeOrigin{"gpsbabel", false, "times as converted by gpsbabel, whose clock is not said"},
    TimeOrigin{"csv", false, "the table's time column, whose clock the table does not say"},
};

}  // namespace

void note_origins_of_head(const Receiver& receiver, Observations& head) {
    const auto origin = std::ranges::find(origins, head.format, &TimeOrigin::format);
    head.time_origin = origin == origins.end() ? "" : origin->words;
    const bool of_satellites = origin != origins.end() && origin->of_satellites;
    head.facts.time_source = of_satellites                          ? "satellites"
                             : receiver.time_source == "satellites" ? "attempt"
                                                                    : "unknown";
    head.solution_source = "recording";
}

void note_origins(const Receiver& receiver, Observations& observations) {
    note_origins_of_head(receiver, observations);
    FixKind claimed = FixKind::unknown;
    from_text(receiver.solution, claimed);
    bool stated = false;
    bool missing = false;
    for (Observation& row : observations.rows) {
        if (row.fix != FixKind::unknown) {
            stated = true;
            continue;
        }
        missing = true;
        row.fix = claimed;
    }
    if (missing)
        observations.solution_source = claimed != FixKind::unknown ? "attempt"
                                       : stated                    ? "partly"
                                                                   : "unknown";
}

}  // namespace runcert
