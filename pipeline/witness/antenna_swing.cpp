#include "witness/antenna_swing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/uncertainty.h"

namespace runcert {
namespace {

constexpr double rounding_s = 1e-7;

/// How far an antenna on a craft that pitches, and rolls with leeway, is ahead of the craft or
/// behind it at most.
double ahead_at_most_m(const AntennaMotion& motion) {
    return motion.height_m * (std::sin(motion.pitch_deg * radians_per_degree) +
                              std::sin(motion.roll_deg * radians_per_degree) *
                                  std::sin(motion.leeway_deg * radians_per_degree));
}

/// The step of the solution that holds an instant, as the index of its first epoch. Empty if
/// there is none, or if only the IMU carries across it.
std::optional<std::size_t> step_at(const InertialSolution& solution, double time_s) {
    const auto& epochs = solution.epochs;
    if (epochs.size() < 2 || time_s < epochs.front().time_s - rounding_s ||
        time_s > epochs.back().time_s + rounding_s)
        return std::nullopt;
    const auto after =
        std::ranges::upper_bound(epochs, time_s + rounding_s, {}, &InertialEpoch::time_s);
    const auto end = static_cast<std::size_t>(after - epochs.begin());
    const std::size_t first = std::min(std::max<std::size_t>(end, 1), epochs.size() - 1) - 1;
    const bool within = time_s > epochs[first].time_s + rounding_s &&
                        time_s < epochs[first + 1].time_s - rounding_s;
    if (within && solution.bridged_between(first, first + 1)) return std::nullopt;
    return first;
}

/// Antenna less reference point at an instant of a step.
Eigen::Vector3d arm_at(const InertialSolution& solution, std::size_t step, double time_s) {
    const InertialEpoch &before = solution.epochs[step], &after = solution.epochs[step + 1];
    return position_between(before, after, time_s, CraftPoint::antenna) -
           position_between(before, after, time_s, CraftPoint::reference_point);
}

/// How fast the antenna swings: the slope of the arm at an instant of a step, and its change.
struct ArmMotion {
    Eigen::Vector3d velocity_m_s;
    Eigen::Vector3d acceleration_m_s2;
};
ArmMotion arm_motion_at(const InertialSolution& solution, std::size_t step, double time_s) {
    const auto swings = [&](std::size_t k) -> Eigen::Vector3d {
        return solution.epochs[k].antenna.velocity_m_s -
               solution.epochs[k].reference_point.velocity_m_s;
    };
    const double from_s = solution.epochs[step].time_s;
    const double step_s = solution.epochs[step + 1].time_s - from_s;
    const Eigen::Vector3d changed = swings(step + 1) - swings(step);
    return {
        .velocity_m_s = swings(step) + std::clamp((time_s - from_s) / step_s, 0.0, 1.0) * changed,
        .acceleration_m_s2 = changed / step_s};
}

/// Length of a point's path from one instant to a later one, horizontally.
double path_m(const InertialSolution& solution, double from_s, double to_s, CraftPoint point) {
    const std::size_t first = *step_at(solution, from_s), last = *step_at(solution, to_s);
    const auto at = [&](std::size_t step, double time_s) -> Eigen::Vector2d {
        return position_between(solution.epochs[step], solution.epochs[step + 1], time_s, point)
            .head<2>();
    };
    double length_m = 0.0;
    Eigen::Vector2d before = at(first, from_s);
    for (std::size_t k = first + 1; k <= last; ++k) {
        const Eigen::Vector2d next = at(k, solution.epochs[k].time_s);
        length_m += (next - before).norm();
        before = next;
    }
    return length_m + (at(last, to_s) - before).norm();
}

}  // namespace

double swing_bound_m_s(const AntennaMotion& motion, double speed_m_s, double duration_s,
                       bool by_path) {
    const double least_m_s = std::max(speed_m_s, 1e-3);
    const double roll = motion.roll_deg * radians_per_degree;
    const double across_m = motion.height_m * std::sin(roll);
    const double ends_m = motion.height_m * std::sin(motion.pitch_deg * radians_per_degree) +
                          across_m * std::sin(motion.leeway_deg * radians_per_degree) +
                          across_m * across_m / (least_m_s * duration_s);
    const double chord_m_s = 2.0 * ends_m / duration_s;
    if (!by_path) return chord_m_s;
    const double swing_m_s = motion.height_m * roll * 2.0 * std::numbers::pi / motion.roll_period_s;
    return chord_m_s + swing_m_s * swing_m_s / (4.0 * least_m_s);
}

Track track_of_craft(const Track& track, const AntennaSwing& swing) {
    if (!swing.solution) return track;
    const InertialSolution& solution = *swing.solution;
    Track craft = track;
    craft.epochs.clear();
    for (TrackEpoch epoch : track.epochs) {
        const auto step = step_at(solution, epoch.time_s);
        if (!step) continue;
        const ArmMotion arm = arm_motion_at(solution, *step, epoch.time_s);
        epoch.position_m -= arm_at(solution, *step, epoch.time_s);
        epoch.velocity_m_s -= arm.velocity_m_s;
        epoch.acceleration_m_s2 -= arm.acceleration_m_s2;
        craft.epochs.push_back(epoch);
    }
    return craft;
}

std::vector<TimedPosition<2>> positions_of_craft(std::span<const TimedPosition<2>> positions,
                                                 const AntennaSwing& swing) {
    std::vector<TimedPosition<2>> of_craft;
    of_craft.reserve(positions.size());
    for (TimedPosition<2> one : positions) {
        if (swing.solution) {
            const auto step = step_at(*swing.solution, one.time_s);
            if (!step) continue;
            one.position -= arm_at(*swing.solution, *step, one.time_s).head<2>();
        } else if (swing.bound) {
            one.sigma_m =
                std::hypot(one.sigma_m, rectangular_uncertainty(ahead_at_most_m(*swing.bound)));
        }
        of_craft.push_back(one);
    }
    return of_craft;
}

std::string swing_text(std::string_view witness, const AntennaSwing& swing) {
    if (swing.solution)
        return fmt::format(
            "The {} are of the craft: they are compared with the path of its reference point, by "
            "the IMU's attitude.",
            witness);
    return fmt::format(
        "The {} are of the craft. Its antenna may be up to {:.2f} m ahead of it or behind "
        "(antenna_motion): a difference that this allows shows no error.",
        witness, ahead_at_most_m(*swing.bound));
}

std::optional<WitnessedMotion<2>> WitnessOfCraft::between(double from_s, double to_s) const {
    auto motion = craft_->between(from_s, to_s);
    if (!motion) return std::nullopt;
    if (!swing_.solution) {
        const double duration_s = to_s - from_s;
        const double sigma_m =
            duration_s *
            rectangular_uncertainty(swing_bound_m_s(
                *swing_.bound, motion->displacement_m.norm() / duration_s, duration_s, true));
        motion->covariance_m2 += sigma_m * sigma_m * Eigen::Matrix2d::Identity();
        return motion;
    }
    const InertialSolution& solution = *swing_.solution;
    const auto enclosing = solution.enclosing(from_s, to_s);
    if (!enclosing || solution.bridged_between(enclosing->first, enclosing->second))
        return std::nullopt;
    const auto first = step_at(solution, from_s), last = step_at(solution, to_s);
    if (!first || !last) return std::nullopt;
    motion->displacement_m +=
        (arm_at(solution, *last, to_s) - arm_at(solution, *first, from_s)).head<2>();
    motion->covariance_m2 +=
        solution.swing(enclosing->first, enclosing->second).covariance_m2.topLeftCorner<2, 2>();
    return motion;
}

std::optional<double> WitnessOfCraft::path_between(double from_s, double to_s) const {
    const auto length_m = craft_->path_between(from_s, to_s);
    if (!length_m || !swing_.solution) return length_m;
    if (!between(from_s, to_s)) return std::nullopt;
    return *length_m + path_m(*swing_.solution, from_s, to_s, CraftPoint::antenna) -
           path_m(*swing_.solution, from_s, to_s, CraftPoint::reference_point);
}

}  // namespace runcert
