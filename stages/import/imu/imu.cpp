#include "stages/import/imu/imu.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/imu/quality.h"
#include "stages/import/imu/raw.h"
#include "stages/import/imu/sampling.h"
#include "stages/import/imu/tie.h"

namespace runcert::imu {
namespace {

/// Takes components along the IMU's axes to components along forward, right, down.
Eigen::Matrix3d craft_from_imu(const ImuAxes& axes, const std::optional<MountAngles>& mount) {
    Eigen::Matrix3d named = Eigen::Matrix3d::Zero();
    const CraftAxis each[] = {axes.x, axes.y, axes.z};
    for (Eigen::Index i = 0; i < 3; ++i) {
        const CraftDirection direction = direction_of(each[i]);
        named(static_cast<Eigen::Index>(direction.component), i) = direction.sign;
    }
    if (!mount) return named;
    const auto turn = [](double degrees, const Eigen::Vector3d& axis) {
        return Eigen::AngleAxisd(Angle::from_degrees(degrees).radians(), axis).toRotationMatrix();
    };
    return turn(mount->yaw, Eigen::Vector3d::UnitZ()) *
           turn(mount->pitch, Eigen::Vector3d::UnitY()) *
           turn(mount->roll, Eigen::Vector3d::UnitX()) * named;
}

/// What is given of an IMU.
struct HeldImu {
    RawFile raw;
    Sampling sampling;
    SampleFaults faults;
    Eigen::Matrix3d craft_from_imu;
};

void give_rows(const HeldImu& held, const TakeRow& take) {
    for (std::size_t i = 0; i < held.raw.samples.size(); ++i) {
        const auto mean = mean_of(held.raw, held.sampling, i);
        if (!mean) continue;
        const RawSample& sample = held.raw.samples[i];
        const Eigen::Vector3d rate = held.craft_from_imu * mean->rate_rad_s;
        const Eigen::Vector3d force = held.craft_from_imu * mean->force_m_s2;
        ImuRow row;
        row.sample = static_cast<std::int64_t>(i) + 1;
        row.time.nanoseconds = sample.time_ns;
        row.interval_s = mean->interval_s;
        row.rate_forward_rad_s = rate.x();
        row.rate_right_rad_s = rate.y();
        row.rate_down_rad_s = rate.z();
        row.force_forward_m_s2 = force.x();
        row.force_right_m_s2 = force.y();
        row.force_down_m_s2 = force.z();
        // Of instants the first after a gap gives no row, and the next says that it was there.
        const bool begins =
            held.sampling.gap_before[i] ||
            (i > 1 && held.sampling.clock.samples == "instant" && held.sampling.gap_before[i - 1]);
        if (begins) row.gap_before = true;
        if (held.faults.repeated[i]) row.repeated = true;
        if (held.faults.saturated[i]) row.saturated = true;
        row.source_line = sample.line;
        take(row);
    }
}

std::int64_t count_of(const std::vector<bool>& marks) {
    return std::count(marks.begin(), marks.end(), true);
}

ImuFaults found_in(const HeldImu& held) {
    return {.gaps = held.sampling.gaps,
            .longest_gap_s = held.sampling.longest_gap_s,
            .left_out = held.sampling.left_out,
            .held = held.sampling.held,
            .repeated = count_of(held.faults.repeated),
            .saturated = count_of(held.faults.saturated),
            .gyro_range_rad_s = held.faults.gyro_range_rad_s,
            .accelerometer_range_m_s2 = held.faults.accelerometer_range_m_s2};
}

double tilt_deg(const HeldImu& held, const Eigen::Vector3d& force) {
    const Eigen::Vector3d craft = held.craft_from_imu * force;
    return Angle::from_radians(std::atan2(std::hypot(craft.x(), craft.y()), -craft.z())).degrees();
}

std::optional<ImuRest> measured_at_rest(const HeldImu& held) {
    const auto quiet = quietest_second(held.raw, held.sampling);
    if (!quiet) return std::nullopt;
    const RawSample& first = held.raw.samples[quiet->begin];
    return ImuRest{.start_s = static_cast<double>(first.time_ns) * 1e-9,
                   .duration_s = static_cast<double>(quiet->end - quiet->begin) *
                                 held.sampling.clock.interval_s,
                   .specific_force_m_s2 = quiet->force_m_s2.norm(),
                   .scatter_m_s2 = quiet->scatter_m_s2,
                   .down_deg = tilt_deg(held, quiet->force_m_s2),
                   .gyro_rad_s = quiet->rate_rad_s.norm()};
}

void note_findings(const ImuTable& head, std::vector<std::string>& notes) {
    if (head.found.repeated > 0)
        notes.push_back(fmt::format("{} samples repeat all six readings of the one before.",
                                    head.found.repeated));
    const auto range = [](const std::optional<double>& value, double unit, const char* name,
                          const char* unit_name) {
        return value ? fmt::format(" {} at {} {}", name, format_fixed(*value / unit, 1), unit_name)
                     : std::string();
    };
    if (head.found.saturated > 0)
        notes.push_back(fmt::format(
            "{} samples have a reading at the end of its range:{}{}.", head.found.saturated,
            range(head.found.gyro_range_rad_s, Angle::from_degrees(1.0).radians(), "gyros",
                  "deg/s"),
            range(head.found.accelerometer_range_m_s2, 1.0,
                  head.found.gyro_range_rad_s ? "and accelerometers" : "accelerometers", "m/s2")));
    constexpr double gravity_m_s2 = 9.8, noted_share = 0.03, noted_tilt_deg = 25.0;
    if (!head.rest) return;
    if (std::abs(head.rest->specific_force_m_s2 / gravity_m_s2 - 1.0) > noted_share)
        notes.push_back(fmt::format(
            "In its quietest second the IMU reads {} m/s2, where gravity is 9.8 m/s2: it "
            "accelerates, or its accelerometers are biased.",
            format_fixed(head.rest->specific_force_m_s2, 2)));
    if (head.rest->down_deg > noted_tilt_deg)
        notes.push_back(fmt::format(
            "In its quietest second the down axis is {} degrees from gravity: the craft leans, or "
            "axes: leave out how the IMU is mounted (mount_deg).",
            format_fixed(head.rest->down_deg, 0)));
}

}  // namespace

StreamedImu import_imu(const Receiver& receiver, const RecordingBytes& file,
                       const RecordingSpan& recording) {
    const Imu& imu = *receiver.imu;
    auto held = std::make_shared<HeldImu>();
    held->raw = read_raw(receiver, file, recording.utc);
    held->sampling = settle_times(imu, file, held->raw);
    held->craft_from_imu = craft_from_imu(held->raw.axes, imu.mount);
    require_gravity(imu, held->raw, held->sampling, held->craft_from_imu.row(2).transpose());
    tie_to_recording(receiver, recording, held->raw);
    held->faults = faults_of(held->raw, held->sampling);
    held->sampling.clock.offset_s = imu.time_offset_s;
    StreamedImu result;
    for (std::size_t i = 0; i < held->raw.samples.size(); ++i)
        if (mean_of(held->raw, held->sampling, i)) ++result.rows;
    ImuTable& head = result.head;
    head.receiver = receiver.id;
    head.first_epoch = recording.first_epoch;
    head.format = held->raw.format;
    head.grade = imu.grade;
    head.antenna = imu.antenna;
    head.arm_sigma_m = 0.5 * imu.arm_expanded_uncertainty_m;
    head.reference_point = imu.reference_point;
    for (const CraftAxis axis : {held->raw.axes.x, held->raw.axes.y, held->raw.axes.z})
        head.axes.emplace_back(to_text(axis));
    head.mount = imu.mount;
    head.clock = held->sampling.clock;
    head.found = found_in(*held);
    head.rest = measured_at_rest(*held);
    head.records = held->raw.records;
    head.notes = held->raw.notes;
    if (!imu.axes && head.format != "kf-gins")
        head.notes.push_back(fmt::format(
            "The attempt does not say how the IMU's axes point; x is taken to point {}, y {}, z "
            "{}.",
            head.axes[0], head.axes[1], head.axes[2]));
    note_findings(head, head.notes);
    result.give = [held](const TakeRow& take) { give_rows(*held, take); };
    return result;
}

}  // namespace runcert::imu
