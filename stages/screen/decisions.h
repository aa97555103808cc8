#pragma once

#include <span>
#include <vector>

#include "stages/screen/adaptation.h"

namespace runcert {

struct MarkOptions {
    bool bridge_steps = false;
    bool on_the_ground = true;  ///< the craft's vertical speed is no result of its own
};

/// Writes what was decided of an arc into its rows (`arc_rows` are their indices). Rows already
/// marked keep their mark. A step ends the arc, or is bridged. Positions that drift are left out:
/// between a ramp and the one that ends it (their rates add up to none), or, where it does not end,
/// on both sides of the ramp, because nobody can tell whether the positions before or after it
/// drift: not beyond the next break, not beyond where the positions stand still (they do not drift
/// there), and no longer than an error takes at this rate to grow to a kilometre; ten seconds where
/// velocities are recorded, which test what is further off. A side that the recorded velocities
/// vouch for (its positions move as they say, to a quarter of the rate, those of the other not to
/// three quarters) loses nothing. Where the recorded velocities change with the positions (to half
/// the rate, in the means of two seconds before and after), it is motion, and nothing is left out;
/// the arc ends there all the same. Returns the decision that cost the arc most epochs; the caller
/// sets its share.
std::optional<LargestDecision> mark_rows(std::vector<ScreenedEpoch>& rows,
                                         std::span<const std::size_t> arc_rows,
                                         const ArcDecisions& decisions, TestedAxes axes,
                                         const MarkOptions& options);

/// Numbers the arcs anew from 1 after rows have been marked: an arc begins and ends with a usable
/// row, and ends where rows are left out for longer than `longest_hole_s`, from a usable one to the
/// next. Those of fewer than `min_arc_epochs` usable rows are taken out (reason short_arc).
void finish_arcs(std::vector<ScreenedEpoch>& rows, double longest_hole_s,
                 std::int64_t min_arc_epochs);

}  // namespace runcert
