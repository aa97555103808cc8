#include "estimation/tables/other_receiver.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geodesy.h"
#include "core/statistics.h"

namespace runcert {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d, Eigen::Vector3d;

/// Beyond this two antennas are not on one craft that turns as a whole.
constexpr double longest_baseline_m = 50.0;
/// A craft points where it goes no better than this, and below this speed nobody knows where.
constexpr double sigma_heading = 0.015;
constexpr double slowest_m_s = 1.0;

bool is_estimated(const TrajectoryEpoch& row) {
    return row.usable && row.arc && row.east_m && row.north_m && row.velocity_east_m_s &&
           row.velocity_north_m_s && row.acceleration_east_m_s2 && row.acceleration_north_m_s2 &&
           row.sigma_east_m && row.sigma_north_m;
}

/// From the other's frame to the own one: places turn and shift, velocities turn.
class FrameChange {
  public:
    FrameChange(const TrajectoryTable& other, const TrajectoryTable& own) {
        if (!other.origin) return;
        from_.emplace(other.origin->position);
        to_.emplace(own.origin->position);
        const auto rotation = [](const Geodetic& place) {
            return rotation_enu_from_ecef(place.latitude, place.longitude);
        };
        turn_ = rotation(own.origin->position) * rotation(other.origin->position).transpose();
    }
    Vector3d place(const Vector3d& enu_m) const {
        return from_ ? to_->enu_from_geodetic(from_->geodetic_from_enu(Enu{enu_m})).m : enu_m;
    }
    Vector3d turned(const Vector3d& enu) const { return turn_ * enu; }

  private:
    std::optional<LocalFrame> from_, to_;
    Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
};

/// An epoch of the other receiver in the own frame and time.
struct Epoch {
    double time_s = 0.0;
    Vector3d position_m, velocity_m_s, acceleration_m_s2;
    Vector3d variance_m2;
    std::int64_t stretch = 0;
};

std::vector<Epoch> epochs_of(const TrajectoryTable& other, const TrajectoryTable& own,
                             bool with_heights) {
    const FrameChange frame(other, own);
    const double later_s =
        static_cast<double>(other.facts.first_epoch->nanoseconds_since(*own.facts.first_epoch)) *
        1e-9;
    std::vector<Epoch> epochs;
    std::int64_t stretch = 0;
    std::optional<std::int64_t> arc;
    for (const TrajectoryEpoch& row : other.rows) {
        if (!is_estimated(row) || (with_heights && !(row.up_m && row.sigma_up_m))) continue;
        if (row.arc != arc || begins_after_step(row)) ++stretch;
        arc = row.arc;
        const Vector3d position(*row.east_m, *row.north_m, row.up_m.value_or(0.0));
        const Vector3d velocity(*row.velocity_east_m_s, *row.velocity_north_m_s,
                                row.velocity_up_m_s.value_or(0.0));
        const Vector3d acceleration(*row.acceleration_east_m_s2, *row.acceleration_north_m_s2, 0.0);
        epochs.push_back({.time_s = row.time.seconds() + later_s,
                          .position_m = frame.place(position),
                          .velocity_m_s = frame.turned(velocity),
                          .acceleration_m_s2 = frame.turned(acceleration),
                          .variance_m2 = Vector3d(*row.sigma_east_m, *row.sigma_north_m,
                                                  row.sigma_up_m.value_or(0.0))
                                             .cwiseAbs2(),
                          .stretch = stretch});
    }
    return epochs;
}

/// The vector between the antennas along and across the track.
Vector2d baseline_of(const std::vector<Epoch>& epochs, const TrajectoryTable& own) {
    std::vector<double> along, across;
    std::size_t k = 0;
    for (const TrajectoryEpoch& row : own.rows) {
        if (!is_estimated(row)) continue;
        constexpr double tolerance_s = 1e-3;
        while (k < epochs.size() && epochs[k].time_s < row.time.seconds() - tolerance_s)
            ++k;
        if (k == epochs.size()) break;
        const Vector2d velocity = epochs[k].velocity_m_s.head<2>();
        if (epochs[k].time_s > row.time.seconds() + tolerance_s || velocity.norm() < slowest_m_s)
            continue;
        const Vector2d track = velocity.normalized();
        const Vector2d apart = epochs[k].position_m.head<2>() - Vector2d(*row.east_m, *row.north_m);
        along.push_back(apart.dot(track));
        across.push_back(apart.dot(Vector2d(-track.y(), track.x())));
    }
    if (along.empty()) return Vector2d::Zero();
    const Vector2d baseline(median(std::move(along)), median(std::move(across)));
    return baseline.norm() <= longest_baseline_m ? baseline : Vector2d::Zero();
}

}  // namespace

template <int Axes>
std::optional<ReceiverWitness<Axes>> receiver_witness(const TrajectoryTable& other,
                                                      const TrajectoryTable& own) {
    if (!other.facts.first_epoch || !own.facts.first_epoch ||
        other.origin.has_value() != own.origin.has_value())
        return std::nullopt;
    const std::vector<Epoch> epochs = epochs_of(other, own, Axes == 1);
    if (epochs.empty()) return std::nullopt;
    const Vector2d baseline = baseline_of(epochs, own);
    std::vector<OtherReceiverEpoch<Axes>> samples;
    samples.reserve(epochs.size());
    for (const Epoch& epoch : epochs) {
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
    return ReceiverWitness<Axes>(std::move(samples));
}

template std::optional<ReceiverWitness<1>> receiver_witness<1>(const TrajectoryTable&,
                                                               const TrajectoryTable&);
template std::optional<ReceiverWitness<2>> receiver_witness<2>(const TrajectoryTable&,
                                                               const TrajectoryTable&);

}  // namespace runcert
