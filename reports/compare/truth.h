#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// Where the craft truly was, and how fast.
struct TruthEpoch {
    ElapsedTime time;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north, m
    double speed_m_s = 0.0;
};

/// Reads what `runcert simulate` writes as truth.csv: comment lines, one of column names, then
/// numbers. Of the columns time_s, east_m, north_m and speed_m_s must be there; others are passed
/// over. Failure with line and column for anything else than numbers, rows of another length, and
/// times that do not increase. `where` names the file.
std::vector<TruthEpoch> read_truth(std::string_view text, const std::string& where);

/// For each row of a trajectory the truth at its time, to half a millisecond; empty where there is
/// none. Both count seconds from the first epoch.
std::vector<std::optional<TruthEpoch>> truth_at_rows(const std::vector<TruthEpoch>& truth,
                                                     const TrajectoryTable& trajectory);

}  // namespace runcert
