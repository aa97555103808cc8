#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/imu/declared.h"
#include "stages/import/recording.h"

/// IMUs beside a receiver: tables with a mapping (`receivers[].imu.columns`), KF-GINS text, NovAtel
/// RAWIMUA and RAWIMUSA.
namespace runcert::imu {

/// The recording that an IMU was recorded beside.
struct RecordingSpan {
    std::optional<GpsTime> first_epoch;  ///< empty where its times are relative
    double span_s = 0.0;                 ///< from the first epoch to the latest
    /// What the recording's own count of time shows at the first epoch (ns), where it has one.
    std::optional<std::int64_t> count_ns = std::nullopt;
    bool utc = false;  ///< whether its stamps are UTC
};

using TakeRow = std::function<void(const ImuRow& row)>;

/// An IMU's samples, whose rows are given one by one, in the order of time.
struct StreamedImu {
    ImuTable head;  ///< without the rows; the caller sets the header
    std::int64_t rows = 0;
    /// Gives them, as often as it is called. It owns what it needs.
    std::function<void(const TakeRow& take)> give;
};

/// Reads the file of a receiver's IMU: times on the recording's scale, means of angular rate
/// (rad/s) and specific force (m/s^2) over intervals, along the craft's axes forward, right, down.
///
/// With `rate_hz` samples are evenly spaced, by a straight line through the stamps of each stretch
/// without a gap. Without `start_gps`, counts of time that have no date are taken for the
/// recording's own, for a count since 1970, for seconds of the GPS week or for seconds from the
/// recording's first epoch: the first of them by which the two share time.
///
/// Failure, with place and remedy, where the file cannot be read; where the times of the two share
/// nothing; where stamps are so uneven that they need `rate_hz`, or contradict it; where gravity
/// has another size (a unit, increments), or does not sit on the down axis; and where gyros read
/// more than any gyro, or turn at rest.
StreamedImu import_imu(const Receiver& receiver, const RecordingBytes& file,
                       const RecordingSpan& recording);

}  // namespace runcert::imu
