#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reports/export/track.h"

namespace runcert {

/// A fact of a feature on the map, its value as text.
struct MapFact {
    std::string name;   ///< for programs
    std::string label;  ///< for people; empty where the feature's name says it already
    std::string value;
};

/// What a feature on the map is called, "nalsa: 232.17 km/h ± 0.17 km/h".
std::string name_of(const TrackWindow& window);
std::string name_of(const TrackArc& arc);
std::string name_of(const TrackGate& gate);

/// What is to be known about a window: rule, outcome, speed, uncertainty, times.
std::vector<MapFact> facts_of(const TrackWindow& window);
std::vector<MapFact> facts_of(const TrackArc& arc);

/// How a window is drawn: colours of Okabe and Ito [OI08], which the colour-blind tell apart.
/// Windows of several rules lie over one another, and get narrower from the first on.
struct LineStyle {
    std::string rgb;  ///< six hexadecimal digits
    int width = 2;
};
LineStyle style_of(const TrackWindow& window);
inline const LineStyle track_style{"333333", 2};
inline const LineStyle gate_style{"000000", 4};

/// What is drawn on the map.
struct MapFeature {
    std::string name;
    LineStyle style;
    std::vector<MapFact> facts = {};
};

inline constexpr int degree_decimals = 9;  ///< 0.1 mm
inline constexpr int height_decimals = 3;

/// The file's own words on what it is: craft, place, receiver, heights, thinning.
std::vector<std::string> about(const Track& track);

}  // namespace runcert
