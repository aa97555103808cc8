#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "schemas/trajectory/declared.h"

namespace runcert {

/// Thresholds that separate one run of the craft from the next.
struct RunThresholds {
    double start_m_s = 2.0;  ///< a run is faster than this at some point
    double stop_m_s = 1.0;   ///< below this the craft stands still
    double stop_s = 5.0;     ///< a run ends when the craft stands, or the estimate is missing, for
                             ///< longer
    double turn_deg = 90.0;  ///< a turn by more than this also ends a run
};

/// A run of the craft, by rows of the trajectory. Both rows have an estimate.
struct CraftRun {
    std::size_t first_row = 0;
    std::size_t last_row = 0;
    RunEdge began = RunEdge::recording;  ///< recording: already moving when the recording begins
    RunEdge ended = RunEdge::recording;
    /// The beginning of the standstill before the run: the first of the consecutive rows below
    /// `stop_m_s` that end with `first_row`. If the craft was at rest, it was in this interval.
    std::optional<std::size_t> stood_from_row = std::nullopt;
};

/// The runs in a trajectory, in order of time. Rows without an estimate are skipped.
///
/// A run begins at the last row below `stop_m_s` before the speed exceeds `start_m_s`. It begins
/// later if the previous run ends at a turn, or the estimate begins, after that row. It ends at the
/// first row of those that stay below `stop_m_s` for `stop_s` or for good. It also ends at the row
/// before an interruption of the estimate longer than `stop_s`, at a turn, or with the recording.
/// Shorter slow parts or interruptions do not end it.
///
/// In a turn, the direction of travel over the last 2 s differs by more than `turn_deg` from that
/// of the run so far. The latter is the displacement from the run's beginning to 2 s ago. The cut
/// is at the slowest row, the last if equal, since the difference was last within half of
/// `turn_deg`, but at most 30 s ago. That row ends one run and begins the next.
///
/// Displacements are integrated velocities, so that steps of the position have no effect. They have
/// a direction if they exceed `stop_m_s` * 2 s, or for the run `start_m_s` * `stop_s`. Before that
/// a run is not cut.
///
/// The cost is linear.
std::vector<CraftRun> runs_in(std::span<const TrajectoryEpoch> rows,
                              const RunThresholds& thresholds = {});

}  // namespace runcert
