#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/export/track.h"
#include "schemas/attempt/attempt.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// Geodetic coordinates (WGS 84), degrees with the nine decimals that are written (0.1 mm).
struct TrackPoint {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    std::optional<double> height_m = {};  ///< above the ellipsoid; empty where not measured
    ElapsedTime time = {};
    std::optional<GpsTime> instant = {};  ///< empty where the recording's time is relative
};

/// A stretch without a gap.
struct TrackArc {
    std::int64_t number = 0;
    std::vector<TrackPoint> points = {};
};

enum class TrackWindowKind {
    best,     ///< the one that the outcome is about
    further,  ///< with the best makes the figure of a rule that takes several
    refused   ///< the fastest of the raw positions, which cannot be certified
};

/// A window of a rule on the track.
struct TrackWindow {
    TrackWindowKind kind = TrackWindowKind::best;
    std::size_t rule = 0;                     ///< number of its rule in the verdict, for its style
    const ProfileVerdict* verdict = nullptr;  ///< of its rule
    WindowSpan span = {};
    double speed_m_s = 0.0;
    std::optional<double> expanded_uncertainty_m_s = {};  ///< k = 2; none for a refused one
    std::vector<std::string> refusals = {};
    std::vector<TrackPoint> points = {};
};

/// A surveyed line of the course.
struct TrackGate {
    std::string name;  ///< "start", "finish"
    TrackPoint left = {}, right = {};
};

/// What of a run lies on the map.
struct Track {
    std::string attempt;
    std::string craft;
    std::string place;  ///< empty where not given
    std::string receiver;
    bool heights_measured = true;
    std::vector<TrackArc> arcs = {};
    std::vector<TrackWindow> windows = {};
    std::vector<TrackGate> gates = {};
};

/// What a track is made of. Windows and verdict are those of the attempt's first receiver, and are
/// left out where the track is another's.
struct TrackInput {
    const Attempt* attempt = nullptr;
    const Receiver* receiver = nullptr;
    const TrajectoryTable* trajectory = nullptr;
    const Windows* windows = nullptr;
    const Verdict* verdict = nullptr;
    std::int64_t every = 1;  ///< of each arc, every so many epochs, and its last; windows are whole
};

/// The smoothed trajectory in geodetic coordinates, cut into arcs at gaps, with windows and gates.
/// Where heights were not measured, the points lie at the attempt's height and state none. Failure
/// where the run is in engineering coordinates, or a window's epoch is not in the trajectory.
Track track_of(const TrackInput& input);

/// A fact of a feature on the map.
struct MapFact {
    std::string label;
    std::string value;
};

/// How a line is drawn: colours of Okabe and Ito [OI08], which the colour-blind tell apart. Windows
/// of several rules lie over one another, and get narrower from the first on.
struct LineStyle {
    std::string rgb;  ///< six hexadecimal digits
    int width = 2;
};

/// What is drawn on the map.
struct MapFeature {
    enum class Kind { track, course, windows };

    std::string name;  ///< "nalsa: 232.17 km/h ± 0.17 km/h"
    LineStyle style;
    std::vector<MapFact> facts = {};
    std::vector<TrackPoint> points = {};
};

/// Those of a kind that have a place, in the order in which they are drawn.
std::vector<MapFeature> features_of(const Track& track, MapFeature::Kind kind);

inline constexpr int degree_decimals = 9;  ///< 0.1 mm
inline constexpr int height_decimals = 3;

/// The file's own words on what it is: craft, place, receiver, heights, thinning.
std::vector<std::string> about(const Track& track);

}  // namespace runcert
