#pragma once

#include <Eigen/Core>

#include "schemas/enu/declared.h"

namespace runcert {

/// The position (m) of an epoch that has one. Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, 1> measured_position(const EnuEpoch& row) {
    if constexpr (Axes == 1)
        return Eigen::Matrix<double, 1, 1>(row.up_m.value());
    else if constexpr (Axes == 2)
        return {row.east_m.value(), row.north_m.value()};
    else
        return {row.east_m.value(), row.north_m.value(), row.up_m.value()};
}

}  // namespace runcert
