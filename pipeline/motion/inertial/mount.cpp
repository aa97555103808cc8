#include "inertial/mount.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr std::size_t least_epochs = 10;

/// The craft's axes by its velocity: forward along it, right level.
Eigen::Matrix3d enu_from_craft(const Eigen::Vector3d& velocity) {
    return rotation_of({.pitch = std::atan2(velocity.z(), velocity.head<2>().norm()),
                        .heading = std::atan2(velocity.x(), velocity.y())});
}

std::vector<Eigen::Matrix3d> gated_mounts(const InertialSolution& solution, const MountGate& gate) {
    std::vector<Eigen::Matrix3d> mounts;
    for (const InertialEpoch& epoch : solution.epochs) {
        const Eigen::Vector3d& v = epoch.reference_point.velocity_m_s;
        const double speed = v.head<2>().norm();
        const double turning = (epoch.enu_from_body * epoch.rate_rad_s).z();
        if (speed < gate.least_speed_m_s || std::abs(turning) * speed > gate.most_lateral_m_s2)
            continue;
        mounts.push_back(enu_from_craft(v).transpose() * epoch.enu_from_body);
    }
    return mounts;
}

}  // namespace

std::optional<MountEstimate> estimate_mount(const InertialSolution& solution,
                                            const MountGate& gate) {
    const std::vector<Eigen::Matrix3d> mounts = gated_mounts(solution, gate);
    if (mounts.size() < least_epochs) return std::nullopt;
    std::vector<bool> used(mounts.size(), true);
    MountEstimate estimate{.epochs = mounts.size()};
    std::vector<Eigen::Vector3d> away(mounts.size());
    for (int round = 0; round < 10; ++round) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < mounts.size(); ++i)
            if (used[i]) sum += mounts[i];
        estimate.craft_from_body = nearest_rotation(sum);
        Eigen::Vector3d limit;
        for (std::size_t i = 0; i < mounts.size(); ++i)
            away[i] = rotation_vector(mounts[i] * estimate.craft_from_body.transpose());
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> sizes;
            for (std::size_t i = 0; i < mounts.size(); ++i)
                if (used[i]) sizes.push_back(std::abs(away[i](axis)));
            limit(axis) = 3.0 * 1.4826 * median(std::move(sizes));
        }
        std::vector<bool> kept(mounts.size());
        for (std::size_t i = 0; i < mounts.size(); ++i)
            kept[i] = (away[i].cwiseAbs().array() <= limit.array()).all();
        if (std::ranges::count(kept, true) < static_cast<std::ptrdiff_t>(least_epochs))
            return std::nullopt;
        if (kept == used) break;
        used = std::move(kept);
    }
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < mounts.size(); ++i)
        if (used[i]) {
            squares += away[i].cwiseAbs2();
            ++estimate.kept;
        }
    estimate.scatter_rad = (squares / static_cast<double>(estimate.kept)).cwiseSqrt();
    // An attitude of forward, right, down against themselves is one against north, east, down.
    estimate.angles = euler_angles(rotation_of({}) * estimate.craft_from_body);
    return estimate;
}

}  // namespace runcert
