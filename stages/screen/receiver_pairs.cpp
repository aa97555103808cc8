#include "stages/screen/receiver_pairs.h"

#include <cmath>

namespace runcert {
namespace {

using Eigen::Vector2d;

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

}  // namespace

std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first) {
    std::vector<ReceiverPair> pairs;
    for (const PositionPair& both : position_pairs(first, second)) {
        ReceiverPair& pair = pairs.emplace_back(ReceiverPair{both});
        const auto& motion = motion_of_first[pair.rows[0]];
        if (!motion || !tells_direction(*motion, pair.difference.head<2>().norm())) continue;
        pair.track = motion->velocity.normalized();
        const Vector2d across(-pair.track->y(), pair.track->x());
        pair.variance_of_direction =
            across.dot(motion->velocity_covariance * across) / motion->velocity.squaredNorm();
    }
    return pairs;
}

}  // namespace runcert
