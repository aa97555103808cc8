#include "stages/screen/receiver_pairs.h"

#include <cmath>

#include "core/geodesy.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

bool tells_direction(const EpochMotion& motion, double length_m) {
    constexpr double slowest_m_s = 1.0;
    constexpr double largest_turn = 0.05;
    const double speed_m_s = motion.velocity.norm();
    const double sigma_m_s = std::sqrt(motion.velocity_covariance.trace());
    if (!(speed_m_s > slowest_m_s && speed_m_s > 10.0 * sigma_m_s)) return false;
    const Vector2d &v = motion.velocity, &a = motion.acceleration;
    const double curvature = std::abs(v.x() * a.y() - v.y() * a.x()) / std::pow(speed_m_s, 3);
    return curvature * length_m <= largest_turn;
}

/// Transforms the positions of one table to the frame of another.
class PositionsInFrame {
  public:
    PositionsInFrame(const std::optional<FrameOrigin>& own,
                     const std::optional<FrameOrigin>& wanted, bool in_space)
        : in_space_(in_space) {
        if (!own || !wanted) return;
        const Geodetic &a = own->position, &b = wanted->position;
        if (own->places.empty() && wanted->places.empty() && a.latitude == b.latitude &&
            a.longitude == b.longitude && a.height_m == b.height_m)
            return;
        own_.emplace(*own);
        wanted_.emplace(*wanted);
    }

    /// `there` is the same moment on the other's clock.
    Vector3d of(const EnuEpoch& row, ElapsedTime there) const {
        const Vector3d own(row.east_m.value(), row.north_m.value(), in_space_ ? *row.up_m : 0.0);
        Vector3d position = own_ ? wanted_->enu_m(there, own_->geodetic(row.time, own)) : own;
        if (!in_space_) position.z() = 0.0;
        return position;
    }

  private:
    bool in_space_;
    std::optional<PlaceFrames> own_, wanted_;
};

Matrix3d covariance_of(const EnuEpoch& row, bool in_space) {
    if (in_space) return stated_covariance<3>(row);
    Matrix3d covariance = Matrix3d::Zero();
    covariance.topLeftCorner<2, 2>() = stated_covariance<2>(row);
    return covariance;
}

}  // namespace

std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first) {
    constexpr std::int64_t tolerance_ns = 1000;
    std::vector<ReceiverPair> pairs;
    if (!first.facts.first_epoch || !second.facts.first_epoch) return pairs;
    if (first.origin.has_value() != second.origin.has_value()) return pairs;
    const bool in_space = first.facts.vertical_measured && second.facts.vertical_measured;
    const PositionsInFrame of_first(first.origin, first.origin, in_space);
    const PositionsInFrame of_second(second.origin, first.origin, in_space);
    const std::int64_t later_ns =
        second.facts.first_epoch->nanoseconds_since(*first.facts.first_epoch);
    std::size_t j = 0;
    for (std::size_t i = 0; i < first.rows.size(); ++i) {
        const ScreenedEpoch& a = first.rows[i];
        if (!a.usable) continue;
        const auto behind_ns = [&] {  // how far the second's row is behind
            return a.time.nanoseconds - second.rows[j].time.nanoseconds - later_ns;
        };
        while (j < second.rows.size() && (!second.rows[j].usable || behind_ns() > tolerance_ns))
            ++j;
        if (j == second.rows.size()) break;
        if (behind_ns() < -tolerance_ns) continue;
        const ScreenedEpoch& b = second.rows[j];
        ReceiverPair pair{.rows = {i, j},
                          .time = a.time,
                          .difference = of_second.of(b, a.time) - of_first.of(a, a.time),
                          .covariance = covariance_of(a, in_space) + covariance_of(b, in_space),
                          .track = std::nullopt};
        const auto& motion = motion_of_first[i];
        if (motion && tells_direction(*motion, pair.difference.head<2>().norm())) {
            pair.track = motion->velocity.normalized();
            const Vector2d across(-pair.track->y(), pair.track->x());
            pair.variance_of_direction =
                across.dot(motion->velocity_covariance * across) / motion->velocity.squaredNorm();
        }
        pairs.push_back(pair);
    }
    return pairs;
}

}  // namespace runcert
