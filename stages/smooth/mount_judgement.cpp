#include "stages/smooth/mount_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/angle.h"
#include "inertial/mount.h"

namespace runcert {
namespace {

MountAngles degrees_of(const EulerAngles& angles) {
    const auto signed_deg = [](double radians) {
        return std::remainder(radians * degrees_per_radian, 360.0);
    };
    return {signed_deg(angles.roll), signed_deg(angles.pitch), signed_deg(angles.heading)};
}

/// Standard uncertainty of a mean whose scatter counts so often.
MountAngles mean_sigma(const MountEstimate& found, std::size_t independent) {
    constexpr double least_sigma_deg = 0.2;
    const auto sigma = [&](double scatter_rad) {
        return std::hypot(least_sigma_deg, scatter_rad * degrees_per_radian /
                                               std::sqrt(static_cast<double>(independent)));
    };
    return {sigma(found.scatter_rad.x()), sigma(found.scatter_rad.y()),
            sigma(found.scatter_rad.z())};
}

/// The surface below each epoch.
struct GroundBelowEpochs {
    std::vector<std::optional<Eigen::Vector3d>> normals;
    std::size_t triangles = 0;  ///< different ones
};

GroundBelowEpochs ground_below(const InertialSolution& solution, const Triangulation& surface) {
    GroundBelowEpochs ground;
    std::set<std::size_t> triangles;
    for (const InertialEpoch& epoch : solution.epochs) {
        auto& normal = ground.normals.emplace_back();
        const auto below = surface.at(epoch.reference_point.position_m.head<2>());
        if (!below) continue;
        normal = below->normal;
        triangles.insert(below->triangle);
    }
    ground.triangles = triangles.size();
    return ground;
}

/// By the normals of a surface.
void judge_on_surface(const InertialSolution& solution, const Triangulation& surface,
                      EstimatedMount& mount) {
    const GroundBelowEpochs ground = ground_below(solution, surface);
    const auto found = estimate_mount(solution, {}, ground.normals);
    if (!found) {
        mount.judgement +=
            " Too few epochs of even motion lie over the surface to judge the axes by it.";
        return;
    }
    mount.on_surface = degrees_of(found->angles);
    mount.sigma_on_surface = mean_sigma(*found, std::min(found->kept, ground.triangles));
    const MountAngles& angles = *mount.on_surface;
    const MountAngles& sigma = *mount.sigma_on_surface;
    // Lean and leeway are no errors of the axes: only what is well beyond both is one.
    constexpr double beyond = 3.0;
    const bool agrees = std::abs(angles.roll) <= beyond * sigma.roll &&
                        std::abs(angles.pitch) <= beyond * sigma.pitch &&
                        std::abs(angles.yaw) <= beyond * sigma.yaw;
    mount.judgement += fmt::format(
        " Against course and surface they are turned by {:.1f} ± {:.1f} degrees in roll, {:.1f} ± "
        "{:.1f} in pitch and {:.1f} ± {:.1f} in yaw (k = 2). {}",
        angles.roll, 2.0 * sigma.roll, angles.pitch, 2.0 * sigma.pitch, angles.yaw, 2.0 * sigma.yaw,
        agrees ? "The axes are as stated."
               : "The axes are not as stated, or the craft leaned or made leeway.");
}

}  // namespace

void judge_mount(const InertialSolution& solution, const Triangulation* surface,
                 EstimatedMount& mount) {
    const auto found = estimate_mount(solution, {});
    if (!found) {
        mount.judgement =
            "The run has too few epochs of even motion at 5 m/s or more to judge the axes.";
        return;
    }
    mount.remaining = degrees_of(found->angles);
    mount.sigma = mean_sigma(*found, found->kept);
    mount.judgement = fmt::format(
        "Against course and level the axes as stated are turned by {:.1f} degrees in roll, {:.1f} "
        "in pitch and {:.1f} in yaw. Slope of the ground, lean and leeway of the craft are in "
        "these figures, so that they correct no other run.",
        mount.remaining->roll, mount.remaining->pitch, mount.remaining->yaw);
    constexpr double noticed_deg = 3.0;
    if (std::max(std::abs(mount.remaining->pitch), std::abs(mount.remaining->yaw)) > noticed_deg)
        mount.judgement +=
            " The distances to antenna and reference point are taken along these axes: if the IMU "
            "is turned in the craft, mount_deg says so.";
    if (surface != nullptr) judge_on_surface(solution, *surface, mount);
}

}  // namespace runcert
