#include "stages/import/imu/quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert::imu {
namespace {

constexpr double gravity_m_s2 = 9.8;
constexpr double standard_gravity = 9.80665;
/// At rest, on a craft whose engine or rigging may shake it.
constexpr double rest_scatter_m_s2 = 1.0;
/// No gyro that is recorded here is biased by more: 20 deg/s.
constexpr double largest_bias_rad_s = 0.35;
/// No gyro measures more: 4000 deg/s.
constexpr double largest_rate_rad_s = 70.0;
/// By which a size that a cause explains may differ from that; no craft's acceleration makes the
/// quietest second, or the mean of a run, weigh less or more than so many times gravity.
constexpr double cause_tolerance = 0.15, least_gravity = 0.5, most_gravity = 2.5;
constexpr double tilt_refused_deg = 60.0;

double interval_s(const RawFile& raw, const Sampling& sampling, std::size_t i) {
    if (i == 0 || sampling.gap_before[i]) return sampling.clock.interval_s;
    return static_cast<double>(raw.samples[i].time_ns - raw.samples[i - 1].time_ns) * 1e-9;
}

/// Sums of a stretch.
struct Sums {
    std::size_t count = 0;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();
    Eigen::Vector3d rate_squares = Eigen::Vector3d::Zero(), force_squares = Eigen::Vector3d::Zero();

    void add(const IntervalMean& mean) {
        ++count;
        rate += mean.rate_rad_s;
        force += mean.force_m_s2;
        rate_squares += mean.rate_rad_s.cwiseAbs2();
        force_squares += mean.force_m_s2.cwiseAbs2();
    }
    Stretch stretch(std::size_t begin, std::size_t end) const {
        const double n = static_cast<double>(std::max<std::size_t>(count, 1));
        const auto scatter = [n](const Eigen::Vector3d& squares, const Eigen::Vector3d& sum) {
            return std::sqrt((squares / n - (sum / n).cwiseAbs2()).cwiseMax(0.0).maxCoeff());
        };
        return {.begin = begin,
                .end = end,
                .rate_rad_s = rate / n,
                .force_m_s2 = force / n,
                .scatter_m_s2 = scatter(force_squares, force),
                .scatter_rad_s = scatter(rate_squares, rate)};
    }
};

/// The end of the range of a kind of readings, and which samples are there.
std::optional<double> range_of(const RawFile& raw, const std::vector<bool>& repeated,
                               Eigen::Vector3d RawSample::*reading, double least,
                               std::vector<bool>& saturated) {
    constexpr int in_a_row = 3;
    constexpr double same = 1e-4;
    double most = 0.0;
    for (const RawSample& sample : raw.samples)
        most = std::max(most, (sample.*reading).cwiseAbs().maxCoeff());
    if (most < least) return std::nullopt;
    bool found = false;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            int row = 0;
            for (std::size_t i = 0; i < raw.samples.size(); ++i) {
                if (repeated[i]) continue;  // one measurement, read twice
                const double value = sign * (raw.samples[i].*reading)[axis];
                row = value >= most * (1.0 - same) ? row + 1 : 0;
                found = found || row >= in_a_row;
            }
        }
    if (!found) return std::nullopt;
    for (std::size_t i = 0; i < raw.samples.size(); ++i)
        if ((raw.samples[i].*reading).cwiseAbs().maxCoeff() >= most * (1.0 - same))
            saturated[i] = true;
    return most;
}

[[noreturn]] void refuse_size(const Imu& imu, double read_m_s2, double interval_s,
                              bool increments) {
    struct Cause {
        double factor;
        const char* what;
        const char* remedy;
    };
    const std::array<Cause, 4> causes{
        {{1.0 / standard_gravity, "that is 1 g, and accelerometer_unit says m/s2",
          "Write accelerometer_unit: g in imu"},
         {standard_gravity, "that is gravity in m/s2, and accelerometer_unit says g",
          "Write accelerometer_unit: m/s2 in imu"},
         {interval_s, "that is gravity times the interval, so that the numbers are increments",
          "Write readings: increments in imu"},
         {1.0 / interval_s,
          "that is gravity over the interval, so that the numbers are rates and no increments",
          "Write readings: rates in imu"}}};
    std::string what, remedy;
    for (const Cause& cause : causes) {
        const bool by_readings = cause.factor == interval_s || cause.factor == 1.0 / interval_s;
        const bool possible =
            by_readings ? increments == (cause.factor == 1.0 / interval_s)
                        : (imu.accelerometer_unit == "g") == (cause.factor == standard_gravity);
        if (!possible ||
            std::abs(read_m_s2 / (gravity_m_s2 * cause.factor) - 1.0) > cause_tolerance)
            continue;
        what += fmt::format("{}{}", what.empty() ? "; " : ", or ", cause.what);
        remedy += fmt::format("{}{}", remedy.empty() ? "" : "; or: ", cause.remedy);
    }
    throw Failure(
        imu.place,
        fmt::format("gravity reads {:.4g} m/s2 where 9.8 m/s2 is right{}", read_m_s2, what),
        remedy.empty() ? "Correct accelerometer_unit, accelerometer_scale or the columns "
                         "of the accelerometers in imu"
                       : remedy);
}

/// "-x", the axis of the IMU nearest to a direction.
std::string nearest_axis(const Eigen::Vector3d& direction) {
    Eigen::Index axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    return fmt::format("{}{}", direction[axis] < 0.0 ? "-" : "", "xyz"[axis]);
}

[[noreturn]] void refuse_axes(const Imu& imu, const Stretch& stretch, const Eigen::Vector3d& down,
                              double tilt_deg) {
    const Eigen::Vector3d gravity = -stretch.force_m_s2;
    const std::string points_down = nearest_axis(gravity), declared = nearest_axis(down);
    const bool opposite = tilt_deg > 180.0 - tilt_refused_deg;
    throw Failure(
        imu.place,
        fmt::format(
            "gravity shows that the IMU's {} axis points down; by axes: {} does, {} degrees "
            "off ({} m/s2 along x, {} along y, {} along z)",
            points_down, declared, format_fixed(tilt_deg, 0),
            format_fixed(stretch.force_m_s2.x(), 2), format_fixed(stretch.force_m_s2.y(), 2),
            format_fixed(stretch.force_m_s2.z(), 2)),
        opposite
            ? "Correct the signs in axes:, or write accelerometer_sense: negative where an axis "
              "that points up reads -9.8 m/s2 at rest"
            : "Exchange the axes in axes: so that this one is down, or correct the columns");
}

}  // namespace

std::optional<IntervalMean> mean_of(const RawFile& raw, const Sampling& sampling, std::size_t i) {
    const RawSample& sample = raw.samples[i];
    const double length_s = interval_s(raw, sampling, i);
    if (raw.increments)
        return IntervalMean{sample.gyro / length_s, sample.accelerometer / length_s, length_s};
    if (sampling.clock.samples == "interval_end")
        return IntervalMean{sample.gyro, sample.accelerometer, length_s};
    if (i == 0 || sampling.gap_before[i]) return std::nullopt;
    const RawSample& before = raw.samples[i - 1];
    return IntervalMean{(before.gyro + sample.gyro) / 2.0,
                        (before.accelerometer + sample.accelerometer) / 2.0, length_s};
}

SampleFaults faults_of(const RawFile& raw, const Sampling& sampling) {
    SampleFaults faults;
    faults.repeated.resize(raw.samples.size(), false);
    faults.saturated.resize(raw.samples.size(), false);
    for (std::size_t i = 1; i < raw.samples.size(); ++i)
        faults.repeated[i] = raw.samples[i].gyro == raw.samples[i - 1].gyro &&
                             raw.samples[i].accelerometer == raw.samples[i - 1].accelerometer;
    const double unit = raw.increments ? sampling.clock.interval_s : 1.0;
    const auto range = [&](Eigen::Vector3d RawSample::*reading, double least) {
        auto most = range_of(raw, faults.repeated, reading, least * unit, faults.saturated);
        if (most) *most /= unit;
        return most;
    };
    constexpr double least_gyro_deg_s = 100.0, least_accelerometer_g = 1.9;
    faults.gyro_range_rad_s =
        range(&RawSample::gyro, Angle::from_degrees(least_gyro_deg_s).radians());
    faults.accelerometer_range_m_s2 =
        range(&RawSample::accelerometer, least_accelerometer_g * standard_gravity);
    return faults;
}

std::optional<Stretch> quietest_second(const RawFile& raw, const Sampling& sampling) {
    const auto length = static_cast<std::size_t>(
        std::max<long long>(std::llround(1.0 / sampling.clock.interval_s), 1));
    std::optional<Stretch> best;
    const auto noise = [](const Stretch& one) {
        // A tenth of a radian a second shakes as much as a metre a second squared.
        return one.scatter_m_s2 + 10.0 * (one.scatter_rad_s + one.rate_rad_s.norm());
    };
    Sums sums;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < raw.samples.size(); ++i) {
        const auto mean = mean_of(raw, sampling, i);
        if (sampling.gap_before[i] || !mean) {
            sums = {};
            begin = i;
        }
        if (!mean) continue;
        sums.add(*mean);
        if (sums.count < length) continue;
        const Stretch stretch = sums.stretch(begin, i + 1);
        if (!best || noise(stretch) < noise(*best)) best = stretch;
        sums = {};
        begin = i + 1;
    }
    return best;
}

Stretch whole_file(const RawFile& raw, const Sampling& sampling) {
    Sums sums;
    for (std::size_t i = 0; i < raw.samples.size(); ++i)
        if (const auto mean = mean_of(raw, sampling, i)) sums.add(*mean);
    return sums.stretch(0, raw.samples.size());
}

bool may_be_at_rest(const Stretch& stretch) {
    const double size = stretch.force_m_s2.norm();
    // Whatever the unit: the scatter against gravity.
    return stretch.scatter_m_s2 < rest_scatter_m_s2 / gravity_m_s2 * size;
}

void require_gravity(const Imu& imu, const RawFile& raw, const Sampling& sampling,
                     const Eigen::Vector3d& down) {
    const Stretch whole = whole_file(raw, sampling);
    const auto quiet = quietest_second(raw, sampling);
    const bool rests = quiet && may_be_at_rest(*quiet);
    const Stretch& judged = rests ? *quiet : whole;
    const double size = judged.force_m_s2.norm();
    if (!(size >= least_gravity * gravity_m_s2 && size <= most_gravity * gravity_m_s2))
        refuse_size(imu, size, sampling.clock.interval_s, raw.increments);
    const double cosine = -judged.force_m_s2.dot(down) / size;
    const double tilt_deg = Angle::from_radians(std::acos(std::clamp(cosine, -1.0, 1.0))).degrees();
    if (tilt_deg > tilt_refused_deg) refuse_axes(imu, judged, down, tilt_deg);
    double most = 0.0;
    for (std::size_t i = 0; i < raw.samples.size(); ++i)
        if (const auto mean = mean_of(raw, sampling, i))
            most = std::max(most, mean->rate_rad_s.cwiseAbs().maxCoeff());
    const double resting = rests ? judged.rate_rad_s.norm() : 0.0;
    if (most <= largest_rate_rad_s && resting <= largest_bias_rad_s) return;
    const bool by_rest = resting > largest_bias_rad_s;
    throw Failure(
        imu.place,
        fmt::format("the gyros read {:.3g} rad/s {}, {:.3g} deg/s", by_rest ? resting : most,
                    by_rest ? "in the quietest second" : "at most",
                    Angle::from_radians(by_rest ? resting : most).degrees()),
        imu.gyro_unit == "rad/s"
            ? "Write gyro_unit: deg/s in imu, if they are in degrees a second"
            : "Correct gyro_unit, gyro_scale or the columns of the gyros in imu");
}

}  // namespace runcert::imu
