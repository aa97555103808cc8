#pragma once

#include <span>
#include <vector>

#include "stages/screen/adaptation.h"

namespace runcert {

/// Writes the decisions on an arc into its rows (`arc_rows` are their indices). Rows already marked
/// keep their mark. A step ends the arc. `on_the_ground` says that the craft's vertical speed is
/// not a result in its own right.
///
/// Positions that drift are left out between a ramp and the one that ends it (their rates sum to
/// zero). Where the drift does not end, both sides of the ramp are left out, because it is unknown
/// which side drifts. This reaches no further than the next break, or the place where positions
/// stand still, which is no drift. It lasts no longer than an error takes to grow to a kilometre at
/// this rate, or ten seconds where velocities are recorded, which test the rest.
///
/// A side that the recorded velocities confirm loses nothing. Its positions must move as the
/// velocities say, to a quarter of the rate, and those of the other side must not, to three
/// quarters. Where the recorded velocities change with the positions (to half the rate, in the
/// means of two seconds before and after), it is real motion. Nothing is left out then, but the arc
/// still ends there.
///
/// Returns the decision that cost the arc most epochs. The caller sets its share.
std::optional<LargestDecision> mark_rows(std::vector<ScreenedEpoch>& rows,
                                         std::span<const std::size_t> arc_rows,
                                         const ArcDecisions& decisions, TestedAxes axes,
                                         bool on_the_ground = true);

/// Renumbers the arcs from 1 after rows have been marked. An arc begins and ends with a usable row.
/// It ends where more than `longest_hole_s` lies between consecutive usable rows. Arcs with fewer
/// than `min_arc_epochs` usable rows are removed (reason short_arc).
void finish_arcs(std::vector<ScreenedEpoch>& rows, double longest_hole_s,
                 std::int64_t min_arc_epochs);

}  // namespace runcert
