#include "stages/import/imu/raw.h"

#include <fmt/format.h>

#include "core/angle.h"
#include "core/failure.h"
#include "stages/import/row_collector.h"

namespace runcert::imu {
namespace {

constexpr double standard_gravity_m_s2 = 9.80665;

/// What the attempt says, else what the format has.
void settle_axes(const Imu& imu, RawFile& raw) {
    if (imu.axes) {
        raw.axes = *imu.axes;
        return;
    }
    if (raw.format == "novatel")
        raw.axes = {.x = CraftAxis::right, .y = CraftAxis::forward, .z = CraftAxis::up};
    else
        raw.axes = {.x = CraftAxis::forward, .y = CraftAxis::right, .z = CraftAxis::down};
}

}  // namespace

void read_lines(const RecordingBytes& file, const SampleOfLine& sample_of, RawFile& raw) {
    RecordLog log;
    LineReader lines(file);
    for (auto line = lines.next(); line; line = lines.next()) {
        try {
            std::optional<RawSample> sample = sample_of(*line, lines.at_end() && !line->ended);
            if (!sample) continue;
            sample->line = static_cast<std::int32_t>(line->number);
            raw.samples.push_back(*sample);
            log.count_good();
        } catch (const Failure& failure) {
            log.count_bad(*line, failure, std::ssize(raw.samples));
        }
    }
    raw.records = std::move(log).finish(raw.notes);
}

double gyro_unit(const Imu& imu) {
    return imu.gyro_scale.value_or(1.0) *
           (imu.gyro_unit == "deg/s" ? Angle::from_degrees(1.0).radians() : 1.0);
}

double accelerometer_unit(const Imu& imu) {
    return imu.accelerometer_scale.value_or(1.0) *
           (imu.accelerometer_unit == "g" ? standard_gravity_m_s2 : 1.0) *
           (imu.accelerometer_sense == ImuSense::negative ? -1.0 : 1.0);
}

void require_possible(const RawSample& sample, const Cell& first) {
    constexpr std::int64_t longest_ns = 4'000'000'000'000'000'000;
    constexpr double largest = 1e6;  // rad/s, m/s^2, whatever the unit or scale should have been
    if (sample.time_ns > longest_ns || sample.time_ns < -longest_ns)
        first.fail("the time is more than 120 years from its zero",
                   "Hand in the file as the logger wrote it, or correct time_unit");
    if (sample.gyro.cwiseAbs().maxCoeff() > largest ||
        sample.accelerometer.cwiseAbs().maxCoeff() > largest)
        first.fail("a reading is as large as no sensor reads",
                   "Hand in the file as the logger wrote it, or correct units and scales");
}

RawFile read_raw(const Receiver& receiver, const RecordingBytes& file, bool utc) {
    require_readable(file);
    const Imu& imu = *receiver.imu;
    const std::string_view head = file.bytes.substr(0, recognised_by);
    RawFile raw;
    if (!imu.columns.empty())
        raw = read_table(receiver, file, utc);
    else if (is_rawimu(head))
        raw = read_rawimu(receiver, file);
    else if (is_kf_gins(head))
        raw = read_kf_gins(receiver, file);
    else
        throw Failure(imu.place,
                      fmt::format("the format of \"{}\" is not recognised as an IMU's, and the "
                                  "attempt names no columns",
                                  imu.file),
                      "Write columns: {time: ..., gyro_x: ..., accelerometer_x: ...}; runcert "
                      "inspect proposes them. Recognised are KF-GINS text, NovAtel RAWIMUA and "
                      "RAWIMUSA");
    settle_axes(imu, raw);
    if (raw.samples.empty())
        throw Failure(place_in(file, RecordPlace(std::size_t{0})), "the file has no samples",
                      "Hand in the whole file, as the IMU's logger wrote it");
    if (raw.increments && imu.samples == ImuSampling::instant)
        throw Failure(imu.place,
                      "increments are of an interval, and samples: instant of an instant",
                      "Write samples: interval_end, or readings: rates");
    return raw;
}

}  // namespace runcert::imu
