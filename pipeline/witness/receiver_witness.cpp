#include "witness/receiver_witness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geodesy.h"
#include "core/statistics.h"

namespace runcert {

template <int Axes>
ReceiverWitness<Axes>::ReceiverWitness(std::vector<OtherReceiverEpoch<Axes>> epochs,
                                       double longest_step_s)
    : epochs_(std::move(epochs)), longest_step_s_(longest_step_s) {}

template <int Axes>
std::optional<typename ReceiverWitness<Axes>::InterpolatedPosition>
ReceiverWitness<Axes>::position_at(double time_s) const {
    constexpr double rounding_s = 1e-6;
    const auto after = std::ranges::upper_bound(epochs_, time_s + rounding_s, {},
                                                &OtherReceiverEpoch<Axes>::time_s);
    if (after == epochs_.begin()) return std::nullopt;
    const auto k = static_cast<std::size_t>(after - epochs_.begin()) - 1;
    const OtherReceiverEpoch<Axes>& a = epochs_[k];
    if (time_s - a.time_s <= rounding_s)
        return InterpolatedPosition{k, a.position_m, a.covariance_m2};
    if (after == epochs_.end() || after->stretch != a.stretch) return std::nullopt;
    const OtherReceiverEpoch<Axes>& b = *after;
    const double h = b.time_s - a.time_s;
    if (h > longest_step_s_) return std::nullopt;
    const double s = (time_s - a.time_s) / h;
    const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
    const double to_b = 10.0 * s3 - 15.0 * s4 + 6.0 * s5;
    const PositionVector<Axes> velocities = (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5) * a.velocity_m_s +
                                            (-4.0 * s3 + 7.0 * s4 - 3.0 * s5) * b.velocity_m_s;
    const PositionVector<Axes> accelerations =
        0.5 * (s2 - 3.0 * s3 + 3.0 * s4 - s5) * a.acceleration_m_s2 +
        0.5 * (s3 - 2.0 * s4 + s5) * b.acceleration_m_s2;
    return InterpolatedPosition{k,
                                a.position_m + to_b * (b.position_m - a.position_m) +
                                    h * velocities + h * h * accelerations,
                                a.covariance_m2.cwiseMax(b.covariance_m2)};
}

template <int Axes>
std::optional<WitnessedMotion<Axes>> ReceiverWitness<Axes>::between(double from_s,
                                                                    double to_s) const {
    const auto from = position_at(from_s);
    const auto to = position_at(to_s);
    if (!from || !to || epochs_[from->epoch].stretch != epochs_[to->epoch].stretch)
        return std::nullopt;
    WitnessedMotion<Axes> motion;
    motion.displacement_m = to->position_m - from->position_m;
    motion.covariance_m2 = from->covariance_m2 + to->covariance_m2;
    return motion;
}

template <int Axes>
TimeSpan ReceiverWitness<Axes>::covered() const {
    if (epochs_.empty()) return {};
    return {.first_s = epochs_.front().time_s, .last_s = epochs_.back().time_s};
}

template <int Axes>
std::optional<double> ReceiverWitness<Axes>::path_between(double from_s, double to_s) const {
    const auto from = position_at(from_s);
    const auto to = position_at(to_s);
    if (!from || !to || epochs_[from->epoch].stretch != epochs_[to->epoch].stretch)
        return std::nullopt;
    double path_m = 0.0;
    PositionVector<Axes> last_m = from->position_m;
    for (std::size_t k = from->epoch + 1; k <= to->epoch; ++k) {
        path_m += (epochs_[k].position_m - last_m).norm();
        last_m = epochs_[k].position_m;
    }
    return path_m + (to->position_m - last_m).norm();
}

template class ReceiverWitness<1>;
template class ReceiverWitness<2>;

namespace {

using Eigen::Matrix2d, Eigen::Vector2d, Eigen::Vector3d;

/// Antennas further apart are not on one craft that turns as a whole.
constexpr double longest_baseline_m = 50.0;
/// Uncertainty of a craft's heading (rad) taken from its track, and the speed below which the track
/// gives no heading.
constexpr double sigma_heading = 0.015;
constexpr double slowest_m_s = 1.0;

/// Transforms from the other receiver's frame to the own one. Places are rotated and shifted,
/// velocities only rotated.
class FrameChange {
  public:
    FrameChange(const Track& other, const Track& own) {
        if (!other.origin) return;
        from_.emplace(*other.origin);
        to_.emplace(*own.origin);
    }
    /// Transforms an epoch of the other receiver, at a time given on both clocks.
    void apply(TrackEpoch& epoch, ElapsedTime there, ElapsedTime here) const {
        if (!from_) return;
        epoch.position_m = to_->enu_m(here, from_->geodetic(there, epoch.position_m));
        const Geodetic& place = from_->at(there).origin();
        const Eigen::Matrix3d turn =
            to_->at(here).rotation_from_local(place.latitude, place.longitude);
        epoch.velocity_m_s = turn * epoch.velocity_m_s;
        epoch.acceleration_m_s2 = turn * epoch.acceleration_m_s2;
    }

  private:
    std::optional<PlaceFrames> from_, to_;
};

ElapsedTime elapsed(double time_s) {
    return {std::llround(time_s * 1e9)};
}

/// The other receiver's usable epochs, in the own frame and time.
std::vector<TrackEpoch> epochs_of(const Track& other, const Track& own, bool with_heights) {
    const FrameChange frame(other, own);
    const double later_s =
        static_cast<double>(other.first_epoch->nanoseconds_since(*own.first_epoch)) * 1e-9;
    std::vector<TrackEpoch> epochs;
    for (TrackEpoch epoch : other.epochs) {
        if (!epoch.usable || (with_heights && !epoch.has_height)) continue;
        frame.apply(epoch, elapsed(epoch.time_s), elapsed(epoch.time_s + later_s));
        epoch.time_s += later_s;
        epochs.push_back(epoch);
    }
    return epochs;
}

/// The vector between the antennas, along and across the track. Epochs within `tolerance_s` of each
/// other are compared; the motion carries one to the time of the other.
Vector2d baseline_of(const std::vector<TrackEpoch>& epochs, double tolerance_s, const Track& own) {
    std::vector<double> along, across;
    std::size_t k = 0;
    for (const TrackEpoch& at : own.epochs) {
        if (!at.usable) continue;
        while (k < epochs.size() && epochs[k].time_s < at.time_s - tolerance_s)
            ++k;
        if (k == epochs.size()) break;
        const double to_s = at.time_s - epochs[k].time_s;
        const Vector3d velocity = epochs[k].velocity_m_s + to_s * epochs[k].acceleration_m_s2;
        if (to_s < -tolerance_s || velocity.head<2>().norm() < slowest_m_s) continue;
        const Vector2d track = velocity.head<2>().normalized();
        const Vector3d moved = 0.5 * to_s * (epochs[k].velocity_m_s + velocity);
        const Vector2d apart = (epochs[k].position_m + moved - at.position_m).head<2>();
        along.push_back(apart.dot(track));
        across.push_back(apart.dot(Vector2d(-track.y(), track.x())));
    }
    if (along.empty()) return Vector2d::Zero();
    const Vector2d baseline(median(std::move(along)), median(std::move(across)));
    return baseline.norm() <= longest_baseline_m ? baseline : Vector2d::Zero();
}

}  // namespace

template <int Axes>
std::optional<ReceiverWitness<Axes>> receiver_witness(const Track& other, const Track& own) {
    if (!other.first_epoch || !own.first_epoch ||
        other.origin.has_value() != own.origin.has_value())
        return std::nullopt;
    const std::vector<TrackEpoch> epochs = epochs_of(other, own, Axes == 1);
    if (epochs.empty()) return std::nullopt;
    const Vector2d baseline = baseline_of(epochs, 0.5 * other.nominal_interval_s, own);
    std::vector<OtherReceiverEpoch<Axes>> samples;
    samples.reserve(epochs.size());
    for (const TrackEpoch& epoch : epochs) {
        OtherReceiverEpoch<Axes>& sample = samples.emplace_back();
        sample.time_s = epoch.time_s;
        sample.stretch = epoch.stretch;
        if constexpr (Axes == 1) {
            sample.position_m = epoch.position_m.tail<1>();
            sample.velocity_m_s = epoch.velocity_m_s.tail<1>();
            sample.covariance_m2 = epoch.variance_m2.tail<1>();
        } else {
            const Vector2d velocity = epoch.velocity_m_s.head<2>();
            const bool moves = velocity.norm() >= slowest_m_s;
            Matrix2d craft = Matrix2d::Identity();
            if (moves)
                craft << velocity.normalized(), Vector2d(-velocity.y(), velocity.x()).normalized();
            const double angle = moves ? sigma_heading : 1.0;
            sample.position_m = epoch.position_m.head<2>() - craft * baseline;
            sample.velocity_m_s = velocity;
            sample.acceleration_m_s2 = epoch.acceleration_m_s2.head<2>();
            sample.covariance_m2 = Matrix2d(epoch.variance_m2.head<2>().asDiagonal()) +
                                   angle * angle * baseline.squaredNorm() * Matrix2d::Identity();
        }
    }
    constexpr double longest_step = 1.5;
    return ReceiverWitness<Axes>(std::move(samples), longest_step * other.nominal_interval_s);
}

template std::optional<ReceiverWitness<1>> receiver_witness<1>(const Track&, const Track&);
template std::optional<ReceiverWitness<2>> receiver_witness<2>(const Track&, const Track&);

}  // namespace runcert
