#pragma once

#include <optional>
#include <string>

#include "stages/import/csv/columns.h"

namespace runcert::imu {

/// The columns of a table that may be an IMU's, and the units that their names say.
struct FoundColumns {
    ImuColumns columns;  ///< by name, or by number where there are no names
    std::string gyro_unit = {}, accelerometer_unit = {},
                time_unit = {};  ///< empty: no name says it
    bool by_names = false;
};

/// By names ("gx", "gyro_x (deg/s)", "ax_mps2", "accelerationX", "timestamp"); of a table without
/// them by numbers. Nothing where these are no gyros and accelerometers.
std::optional<FoundColumns> find_imu_columns(const csv::SeenTable& table);

}  // namespace runcert::imu
