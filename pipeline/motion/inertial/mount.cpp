#include "inertial/mount.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/statistics.h"
#include "inertial/surface_attitude.h"

namespace runcert {
namespace {

constexpr std::size_t least_epochs = 10;

std::vector<Eigen::Matrix3d> gated_mounts(const InertialSolution& solution, const MountGate& gate,
                                          std::span<const std::optional<Eigen::Vector3d>> normals) {
    std::vector<Eigen::Matrix3d> mounts;
    for (std::size_t k = 0; k < solution.epochs.size(); ++k) {
        const InertialEpoch& epoch = solution.epochs[k];
        const Eigen::Vector3d& v = epoch.reference_point.velocity_m_s;
        const double speed = v.head<2>().norm();
        const double turning = (epoch.enu_from_body * epoch.rate_rad_s).z();
        if (!(speed > 0.0) || speed < gate.least_speed_m_s ||
            std::abs(turning) * speed > gate.most_lateral_m_s2)
            continue;
        if (!normals.empty() && !normals[k]) continue;
        const Eigen::Vector3d normal = normals.empty() ? level_normal(v) : *normals[k];
        if (const auto enu_from_craft = attitude_on_surface({normal, v}, gate.least_speed_m_s))
            mounts.push_back(enu_from_craft->transpose() * epoch.enu_from_body);
    }
    return mounts;
}

}  // namespace

std::optional<MountEstimate> estimate_mount(
    const InertialSolution& solution, const MountGate& gate,
    std::span<const std::optional<Eigen::Vector3d>> normals) {
    if (!normals.empty() && normals.size() != solution.epochs.size())
        throw Failure("surface",
                      fmt::format("{} normals are given for {} epochs", normals.size(),
                                  solution.epochs.size()),
                      "Give one for each epoch");
    const std::vector<Eigen::Matrix3d> mounts = gated_mounts(solution, gate, normals);
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
        std::vector<bool> used_now(mounts.size());
        for (std::size_t i = 0; i < mounts.size(); ++i)
            used_now[i] = (away[i].cwiseAbs().array() <= limit.array()).all();
        if (std::ranges::count(used_now, true) < static_cast<std::ptrdiff_t>(least_epochs))
            return std::nullopt;
        if (used_now == used) break;
        used = std::move(used_now);
    }
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < mounts.size(); ++i)
        if (used[i]) {
            squares += away[i].cwiseAbs2();
            ++estimate.retained;
        }
    estimate.scatter_rad = (squares / static_cast<double>(estimate.retained)).cwiseSqrt();
    // An attitude of forward, right, down against themselves is one against north, east, down.
    estimate.angles = euler_angles(rotation_of({}) * estimate.craft_from_body);
    return estimate;
}

}  // namespace runcert
