#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "schemas/screened/screened.h"

namespace runcert {

/// An epoch common to two receivers.
struct PositionPair {
    std::array<std::size_t, 2> rows{};  ///< of the first and of the second table
    ElapsedTime time;                   ///< of the first
    Eigen::Vector3d difference;         ///< second minus first, m; up is 0 if heights are not used
    Eigen::Matrix3d covariance;
};

/// The pairs of usable rows within a microsecond of each other, in order of time, along the axes of
/// the first's frame. Empty if a recording's time is relative, or only one of the two is
/// georeferenced. Differences include heights where both recordings have them.
std::vector<PositionPair> position_pairs(const ScreenedTable& first, const ScreenedTable& second);

}  // namespace runcert
