#include "stages/smooth/arm_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/text.h"

namespace runcert {
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

}  // namespace runcert
