#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/document/document.h"
#include "schemas/profile/profile.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// What a map is made of. Windows and verdict are those of the attempt's first receiver, and are
/// left out where the map is of another's track.
struct MapInput {
    const Attempt* attempt = nullptr;
    const Receiver* receiver = nullptr;
    const TrajectoryTable* trajectory = nullptr;
    const Windows* windows = nullptr;
    const Verdict* verdict = nullptr;
    std::int64_t every = 1;  ///< of each arc, every so many epochs, and its last; windows are whole
};

/// A line on the map, or a point where it has but one.
struct MapLine {
    std::string name;  ///< "nalsa: 232.17 km/h ± 0.17 km/h"
    std::string rgb;   ///< six hexadecimal digits
    int width = 2;
    std::vector<Fact> facts = {};
    /// Longitude and latitude (WGS 84, degrees to 0.1 mm) and, where it was measured, height above
    /// the ellipsoid (m), separated by commas.
    std::vector<std::string> points = {};
};

/// Lines in the order in which they are drawn: "windows", "course", "track".
struct MapFolder {
    std::string name;
    std::vector<MapLine> lines = {};
};

/// What of a run lies on the map.
struct RunMap {
    std::string name;
    std::vector<std::string> about;  ///< craft, place, receiver, heights
    std::vector<MapFolder> folders;  ///< those that hold anything
};

/// The smoothed trajectory, cut into arcs at gaps, with windows and gates. Where heights were not
/// measured, the points lie at the attempt's height and state none. Failure where the run is in
/// engineering coordinates, or a window's epoch is not in the trajectory.
RunMap map_of(const MapInput& input);

/// KML 2.2 for Google Earth: lines clamped to the ground, because ellipsoidal heights are not
/// heights above sea level. Text from outside is escaped for XML and, in descriptions, for HTML.
std::string kml_text(const RunMap& map);

/// A table (ECSV, named `where` in messages) as plain CSV: one header row, no comments, LF. Numbers
/// stay; text that a spreadsheet would take for a formula gets an apostrophe before it.
std::string csv_text(std::string_view table, const std::string& where);

/// A row for each epoch of the trajectory as plain CSV: its number, time, UTC where that is known,
/// smoothed horizontal speed, and under each rule the speed over its length that ends there
/// (`speeds_over_length`). A rule of another kind of window has no column.
std::string rule_speeds_csv(const TrajectoryTable& trajectory,
                            const std::vector<Profile>& profiles);

}  // namespace runcert
