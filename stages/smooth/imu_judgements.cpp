#include "stages/smooth/imu_judgements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "core/angle.h"
#include "core/prose.h"
#include "core/text.h"
#include "inertial/antenna_baseline.h"
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
    mount.sigma_on_surface = mean_sigma(*found, std::min(found->retained, ground.triangles));
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
    mount.sigma = mean_sigma(*found, found->retained);
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

namespace {

constexpr double freedom_m = 0.5;
constexpr double least_known_m = 0.15;
constexpr double as_recorded = 2.0;
constexpr double beyond_chance = 3.29;
constexpr double most_m = 1.05;  ///< a metre and what the motion shows it to

/// Positions that show the arm as well as all do, at a tenth of the time.
constexpr std::size_t enough = 3000;

/// The positions around the fastest one.
std::span<const PositionFix> fast_part(const InertialInput& input,
                                       const InertialSolution& solution) {
    const std::span<const PositionFix> all(input.fixes);
    if (all.size() <= enough || solution.epochs.empty()) return all;
    const auto fastest =
        std::ranges::max_element(solution.epochs, {}, [](const InertialEpoch& epoch) {
            return epoch.antenna.velocity_m_s.head<2>().squaredNorm();
        });
    const auto at = std::ranges::lower_bound(all, fastest->time_s, {}, &PositionFix::time_s);
    const auto middle = static_cast<std::size_t>(at - all.begin());
    const std::size_t first = std::min(middle - std::min(middle, enough / 2), all.size() - enough);
    const auto part = all.subspan(first, enough);
    const bool is_reached = positions_within(input.samples, part, input.setup) >= least_positions;
    return is_reached ? part : all;
}

}  // namespace

std::optional<InertialSolution> solution_with_arm_shown(const InertialInput& input,
                                                        const InertialSolution& as_stated,
                                                        EstimatedArm& arm,
                                                        std::vector<std::string>& notes) {
    const bool with_offset = as_stated.time_offset_s.sigma > 0.0;
    InertialSetup setup = input.setup;
    setup.estimate_antenna = true;
    setup.antenna_sigma_m = freedom_m;
    setup.estimate_time_offset = with_offset;
    if (as_stated.consistency.consistent()) {
        setup.noise = as_stated.noise;
        setup.fit_noise = false;
    }
    const InertialSolution free =
        smooth_inertial(input.samples, fast_part(input, as_stated), setup);
    const Eigen::Vector3d shown = free.antenna_m.value;
    const Eigen::Vector3d sigma = as_recorded * free.antenna_m.sigma;
    if (!free.consistency.consistent() || sigma.maxCoeff() > least_known_m) return std::nullopt;
    arm.estimated = lever_arm_of(shown);
    arm.sigma = lever_arm_of(sigma);

    const Eigen::Vector3d stated = input.setup.antenna_m;
    const Eigen::Array3d combined =
        (sigma.array().square() + input.setup.antenna_sigma_m * input.setup.antenna_sigma_m).sqrt();
    if (((shown - stated).array().abs() <= beyond_chance * combined).all()) return std::nullopt;
    if ((shown - stated).cwiseAbs().maxCoeff() > most_m) return std::nullopt;
    InertialSetup second = input.setup;
    second.antenna_m = shown;
    second.antenna_sigma_m = arm_shown_sigma_m(arm);
    second.estimate_time_offset = with_offset;
    InertialSolution solution = smooth_inertial(input.samples, input.fixes, second);
    if (!solution.consistency.consistent()) return std::nullopt;
    arm.used = lever_arm_of(shown);
    notes.push_back(fmt::format(
        "The motion shows the antenna elsewhere than stated. From the IMU it is {} ({} stated), "
        "with standard uncertainties {}. The attitude rests on what the motion shows, and the "
        "difference is part of the uncertainty. Measure the distances on the craft again.",
        arm_text(lever_arm_of(shown)), arm_text(lever_arm_of(stated)),
        arm_text(lever_arm_of(sigma))));
    return solution;
}

namespace {

/// What the antennas say of the heading, in a sentence.
std::string heading_words(const BaselineJudgement& judged, const std::string& receiver) {
    const double difference_deg = judged.difference_rad.value * degrees_per_radian;
    const double expanded_deg = 2.0 * judged.difference_rad.sigma * degrees_per_radian;
    const std::string text = fmt::format(
        "By the direction to the antenna of {} the heading is {:.2f} degrees {} than by the IMU, "
        "on average over {}. The expanded uncertainty of that is {:.2f} degrees (k = 2). ",
        receiver, std::abs(difference_deg), difference_deg < 0.0 ? "less" : "more",
        counted(std::ssize(judged.headings), "epoch"), expanded_deg);
    return text + (judged.agrees ? "The two agree."
                                 : "The two do not agree: an antenna's place on the craft, or an "
                                   "axis of the IMU, is not as stated.");
}

}  // namespace

void compare_headings(const InertialSolution& solution, const InertialSetup& setup,
                      const std::string& receiver, AttitudeTable& table) {
    if (!setup.baseline) return;
    const Eigen::Vector3d& body_m = setup.baseline->body_m;
    AntennaHeading& comparison = table.baseline.emplace();
    comparison.receiver = receiver;
    comparison.declared = {body_m.x(), body_m.y(), body_m.z()};
    const auto judged = judge_baseline(solution, *setup.baseline, setup.position_error);
    if (!judged) {
        comparison.judgement = fmt::format(
            "The antenna of {} shows no heading: no epoch has heights of both antennas, or one "
            "is stated to be above the other.",
            receiver);
        return;
    }
    comparison.length_m = judged->length_m.value;
    comparison.sigma_length_m = judged->length_m.sigma;
    if (!is_stated_length(*setup.baseline, judged->length_m)) {
        comparison.judgement = fmt::format(
            "The antenna of {} is {:.3f} m away as measured, and {:.3f} m as stated. Its place on "
            "the craft is not as stated, and shows no heading.",
            receiver, judged->length_m.value, body_m.norm());
        return;
    }
    comparison.epochs = std::ssize(judged->headings);
    comparison.difference_deg = judged->difference_rad.value * degrees_per_radian;
    comparison.sigma_deg = judged->difference_rad.sigma * degrees_per_radian;
    comparison.agrees = judged->agrees;
    comparison.judgement = heading_words(*judged, receiver);
    auto row = table.rows.begin();
    for (const BaselineHeading& one : judged->headings) {
        row = std::find_if(row, table.rows.end(), [&](const AttitudeEpoch& each) {
            return each.usable && each.time.seconds() == one.time_s;
        });
        if (row == table.rows.end()) return;
        row->baseline_heading_deg = one.heading_rad * degrees_per_radian;
        row->sigma_baseline_heading_deg = one.sigma_rad * degrees_per_radian;
    }
}

}  // namespace runcert
