#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// What tells one run of the craft from the next.
struct RunThresholds {
    double start_m_s = 2.0;  ///< a run is faster than this somewhere
    double stop_m_s = 1.0;   ///< below it the craft stands
    double stop_s = 5.0;     ///< standing for so long, or no estimate for longer, ends a run
    double turn_deg = 90.0;  ///< so does a turn by more than this
};

/// A run of the craft: rows of the trajectory, both of them with an estimate.
struct CraftRun {
    std::size_t first_row = 0;
    std::size_t last_row = 0;
    RunEdge began = RunEdge::recording;  ///< recording: it was moving where that begins
    RunEdge ended = RunEdge::recording;
    /// Where it began standing: the first of the rows below `stop_m_s`, one after the other, that
    /// `first_row` is the last of. At rest it was somewhere there, if at all.
    std::optional<std::size_t> stood_from_row = std::nullopt;
};

/// The runs in a trajectory, in order of time. Rows without an estimate are passed over.
///
/// A run begins at the last row below `stop_m_s` before it became faster than `start_m_s`; at the
/// turn that ended the run before, or where the estimate begins, if that is later. It ends at the
/// first row of those that stay below `stop_m_s` for `stop_s` or for good; at the row before an
/// interruption of the estimate longer than `stop_s`; at a turn; or with the recording. Slower or
/// interrupted for less time, it goes on.
///
/// A turn: the direction of travel over the last 2 s differs by more than `turn_deg` from that of
/// the displacement from the run's beginning to 2 s ago. It is cut at its slowest row, the last of
/// equals, of those since the difference was last within half of `turn_deg`, 30 s ago at most;
/// that row ends one run and begins the next. Displacements are velocity summed over time, so that
/// steps of the position do not count. They have a direction from `stop_m_s` * 2 s on, the run's
/// from `start_m_s` * `stop_s` on; before it has gone so far a run is not cut.
///
/// Linear.
std::vector<CraftRun> runs_in(std::span<const TrajectoryEpoch> rows,
                              const RunThresholds& thresholds = {});

}  // namespace runcert
