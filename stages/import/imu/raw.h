#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/cell.h"
#include "stages/import/recording.h"

namespace runcert::imu {

/// What the stamps of samples count from.
enum class Stamps {
    none,   ///< there are no stamps
    count,  ///< a zero of their own
    week,   ///< the beginning of the GPS week
    gps     ///< the GPS epoch
};

/// A sample along the axes of the IMU: rad/s and m/s^2, or increments of rad and m/s.
struct RawSample {
    std::int64_t time_ns = 0;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
    Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();
    std::int32_t line = 0;  ///< counted from 1
};

/// A file as it was read.
struct RawFile {
    std::string format;  ///< "csv", "kf-gins", "novatel"
    Stamps stamps = Stamps::count;
    bool increments = false;
    ImuAxes axes;  ///< as the attempt says, or else the format
    RecordCount records;
    std::vector<RawSample> samples;  ///< one at least, in the order of the file
    std::vector<std::string> notes;
};

/// The unit of the gyros in radians a second, and of the accelerometers in metres a second squared,
/// each times its scale and sense. Of increments the same times seconds.
double gyro_unit(const Imu& imu);
double accelerometer_unit(const Imu& imu);

/// Failure at the cell, the first of a sample's, where a time is more than 120 years from its zero,
/// or a reading is one that no sensor gives.
void require_possible(const RawSample& sample, const Cell& first);

/// The sample of a line; nothing where it is no record of the format. `cut_off`: the file ends
/// within the line. Failure where it cannot be read.
using SampleOfLine = std::function<std::optional<RawSample>(const SourceLine& line, bool cut_off)>;

/// Adds the samples of a file of text, one a line at most, and counts the lines that cannot be
/// read. Failure where more than half cannot.
void read_lines(const RecordingBytes& file, const SampleOfLine& sample_of, RawFile& raw);

/// Reads a file in its format. `utc`: dates without a letter are of UTC. Failure where it cannot be
/// read, or more than half of its records cannot.
RawFile read_raw(const Receiver& receiver, const RecordingBytes& file, bool utc);

// The formats. A table is what the attempt names columns of.
RawFile read_table(const Receiver& receiver, const RecordingBytes& file, bool utc);

/// KF-GINS text: seconds of the GPS week, three angle increments (rad), three velocity increments
/// (m/s), along forward, right, down, parted by blanks (i2Nav, "KF-GINS", ReadMe 2.2).
bool is_kf_gins(std::string_view bytes);
RawFile read_kf_gins(const Receiver& receiver, const RecordingBytes& file);

/// NovAtel RAWIMUA and RAWIMUSA ("OEM7 Commands and Logs", RAWIMU): week, seconds, status, counts
/// of velocity Z, -Y, X and of angle Z, -Y, X. The scale of a count is not in the log.
bool is_rawimu(std::string_view bytes);
RawFile read_rawimu(const Receiver& receiver, const RecordingBytes& file);

}  // namespace runcert::imu
