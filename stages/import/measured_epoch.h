#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geodesy.h"
#include "core/gps_time.h"
#include "core/optional_number.h"
#include "core/satellite.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// What a receiver measured of one signal of a satellite.
struct SignalMeasurement {
    Satellite satellite;
    SignalCode signal;
    bool loss_of_lock = false;  ///< the receiver says that the phase was lost since the last epoch
    bool half_cycle = false;    ///< the receiver says that half a cycle is open
    std::int32_t line = 0;      ///< of the file; 0 in binary formats
    OptionalReal phase_cycles = {};
    OptionalReal pseudorange_m = {};
    OptionalReal doppler_hz = {};  ///< positive where the satellite approaches
    OptionalReal strength_db_hz = {};
    OptionalReal lock_time_s = {};  ///< how long the phase has been tracked
};

/// What a receiver measured at an instant of its own clock; by satellite and signal, no signal
/// twice.
struct MeasuredEpoch {
    GpsTime time;
    std::vector<SignalMeasurement> measurements;
    std::int64_t byte = 0;  ///< offset of its first byte in the file
};

/// Puts the measurements in their order, by satellite and signal. Null, or one of a signal that
/// there is twice.
inline const SignalMeasurement* order_measurements(MeasuredEpoch& epoch) {
    const auto key = [](const SignalMeasurement& each) {
        return std::pair(each.satellite, each.signal);
    };
    std::ranges::sort(epoch.measurements, {}, key);
    const auto same = std::ranges::adjacent_find(epoch.measurements, {}, key);
    return same == epoch.measurements.end() ? nullptr : &*same;
}

/// Receives each epoch and may move values out of it.
using TakeMeasurements = std::function<void(MeasuredEpoch&)>;

/// What holds for all of a file's measurements.
struct MeasurementFacts {
    std::string format;  ///< "RINEX 3.03"
    std::string device;  ///< what the file says recorded it; empty where it does not
    std::optional<Ecef> approximate_position;
    RecordCount records;                                ///< epochs
    std::map<SatelliteSystem, std::int64_t> set_aside;  ///< measurements of systems not used
    std::vector<std::string> notes;
};

}  // namespace runcert
