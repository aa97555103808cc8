#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reports/export/track.h"
#include "schemas/profile/profile.h"

namespace runcert {

/// KML 2.2 for Google Earth: arcs, windows (each rule and kind in a style of its own) and gates as
/// lines clamped to the ground, because ellipsoidal heights are not heights above sea
/// level. Text from outside is escaped for XML and, in descriptions, for HTML.
std::string kml_text(const Track& track);

/// A table (ECSV, named `where` in messages) as plain CSV: one header row, no comments, LF. Numbers
/// stay; text that a spreadsheet would take for a formula gets an apostrophe before it.
std::string csv_text(std::string_view table, const std::string& where);

/// A row for each epoch of the trajectory as plain CSV: its number, time, UTC where that is known,
/// smoothed horizontal speed, and under each rule the speed over its length that ends there
/// (`speeds_over_length`). A rule of another kind of window has no column.
std::string rule_speeds_csv(const TrajectoryTable& trajectory,
                            const std::vector<Profile>& profiles);

}  // namespace runcert
