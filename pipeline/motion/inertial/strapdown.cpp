#include "inertial/strapdown.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "inertial/attitude.h"

namespace runcert {
namespace {

/// Times closer than this are the same.
constexpr double same_time_s = 1e-9;
/// A sample's interval may begin so much after the sample before (of the interval) by the jitter of
/// stamps. Beyond it, samples are missing.
constexpr double jitter = 0.5;

std::string location_text(const ImuSample& sample) {
    return fmt::format("IMU, time {:.6f} s", sample.time_s);
}

}  // namespace

StrapdownStep strapdown_step(const NavigationState& state, const ImuSample& sample,
                             const ImuBias& bias, const EarthFrame& earth) {
    const double dt = sample.interval_s;
    const Eigen::Vector3d turned = sample.angle_rad - dt * bias.gyro_rad_s;
    const Eigen::Vector3d plain = sample.velocity_m_s - dt * bias.accelerometer_m_s2;
    const Eigen::Vector3d pushed = plain + 0.5 * turned.cross(plain);
    const Eigen::Vector3d& w = earth.rotation_rad_s();
    StrapdownStep step;
    step.specific_velocity_m_s = rotation_about(-0.5 * dt * w) * (state.enu_from_body * pushed);
    const Eigen::Vector3d gravity =
        earth.gravity_m_s2(state.position_m + 0.5 * dt * state.velocity_m_s);
    const Eigen::Vector3d gained = step.specific_velocity_m_s + dt * gravity;
    const Eigen::Vector3d midway = state.velocity_m_s + 0.5 * gained;
    step.state.velocity_m_s = state.velocity_m_s + gained - 2.0 * dt * w.cross(midway);
    step.state.position_m =
        state.position_m + 0.5 * dt * (state.velocity_m_s + step.state.velocity_m_s);
    step.state.enu_from_body =
        rotation_about(-dt * w) * state.enu_from_body * rotation_about(turned);
    return step;
}

SampleReader::SampleReader(std::span<const ImuSample> samples) : samples_(samples) {
    if (samples.empty())
        throw Failure("IMU", "there are no samples", "Give the IMU's recording of the run");
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const ImuSample& sample = samples[k];
        if (!std::isfinite(sample.time_s) || !sample.angle_rad.allFinite() ||
            !sample.velocity_m_s.allFinite())
            throw Failure(location_text(sample), "a value is not a finite number",
                          "Correct or remove the sample");
        if (!(sample.interval_s > 0.0) || !std::isfinite(sample.interval_s))
            throw Failure(location_text(sample), "the interval is not positive",
                          "Give the interval of each sample");
        if (k > 0 && !(sample.time_s > samples[k - 1].time_s + same_time_s))
            throw Failure(location_text(sample), "the time is not after that of the sample before",
                          "Order the samples by time and remove repeated ones");
    }
    seek(begin_s());
}

double SampleReader::begin_s() const {
    return samples_.front().time_s - samples_.front().interval_s;
}

double SampleReader::end_s() const {
    return samples_.back().time_s;
}

void SampleReader::seek(double time_s) {
    if (!(time_s >= begin_s() - same_time_s && time_s <= end_s() + same_time_s))
        throw Failure("IMU",
                      fmt::format("time {:.3f} s lies outside the samples, {:.3f} to {:.3f} s",
                                  time_s, begin_s(), end_s()),
                      "Check that the IMU was recorded during the run, and on which clock");
    const auto found =
        std::ranges::upper_bound(samples_, time_s + same_time_s, {}, &ImuSample::time_s);
    at_ = static_cast<std::size_t>(found - samples_.begin());
    time_s_ = time_s;
}

std::optional<SampleReader::Piece> SampleReader::next(double until_s) {
    if (until_s - time_s_ <= same_time_s || at_ == samples_.size()) return std::nullopt;
    const ImuSample& sample = samples_[at_];
    double begin = at_ == 0 ? begin_s() : samples_[at_ - 1].time_s;
    const double covered = sample.time_s - sample.interval_s;
    Piece piece;
    if (covered - begin > jitter * sample.interval_s && time_s_ < covered - same_time_s) {
        const double end = std::min(covered, until_s);
        const ImuSample& before = samples_[at_ - 1];
        const double dt = end - time_s_;
        piece = {.sample = {.time_s = end,
                            .interval_s = dt,
                            .angle_rad = 0.5 * dt *
                                         (before.angle_rad / before.interval_s +
                                          sample.angle_rad / sample.interval_s),
                            .velocity_m_s = 0.5 * dt *
                                            (before.velocity_m_s / before.interval_s +
                                             sample.velocity_m_s / sample.interval_s)},
                 .gap_s = covered - begin};
        time_s_ = end;
        return piece;
    }
    if (covered - begin > jitter * sample.interval_s) begin = covered;
    const double end = std::min(sample.time_s, until_s);
    const double share = (end - time_s_) / (sample.time_s - begin);
    piece.sample = {.time_s = end,
                    .interval_s = end - time_s_,
                    .angle_rad = share * sample.angle_rad,
                    .velocity_m_s = share * sample.velocity_m_s};
    time_s_ = end;
    if (sample.time_s - end <= same_time_s) ++at_;
    return piece;
}

Eigen::Vector3d measured_rate_rad_s(std::span<const ImuSample> samples, double time_s) {
    const auto middle_s = [](const ImuSample& sample) {
        return sample.time_s - 0.5 * sample.interval_s;
    };
    const auto rate = [](const ImuSample& sample) -> Eigen::Vector3d {
        return sample.angle_rad / sample.interval_s;
    };
    const auto after = std::ranges::lower_bound(samples, time_s, {}, middle_s);
    if (after == samples.begin()) return rate(samples.front());
    if (after == samples.end()) return rate(samples.back());
    const ImuSample& before = *(after - 1);
    const double share = (time_s - middle_s(before)) / (middle_s(*after) - middle_s(before));
    return (1.0 - share) * rate(before) + share * rate(*after);
}

}  // namespace runcert
