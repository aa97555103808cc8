#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "motion/kalman.h"
#include "stages/smooth/robust.h"

namespace runcert::test {

inline constexpr double given_sigma_m = 0.005;

struct NamedModel {
    std::string name;
    EstimationModel model;
};

/// Persistent and Singer acceleration, each with no error, a steady one and one that grows.
inline std::vector<NamedModel> models() {
    std::vector<NamedModel> all;
    for (const double acceleration_time_s : {std::numeric_limits<double>::infinity(), 3.0})
        for (const auto& [name, error] : {std::pair("no error", GaussMarkovError::steady(0.0, 1.0)),
                                          std::pair("steady", GaussMarkovError::steady(0.008, 2.0)),
                                          std::pair("growing", GaussMarkovError{.tau_s = 10.0,
                                                               .process_density = 0.04,
                                                               .initial_sigma_m = 0.0276})}) {
            EstimationModel model;
            model.motion.jerk_density = 1.5;
            model.motion.acceleration_time_s = acceleration_time_s;
            model.measurement_scale = 1.3;
            model.error = error;
            all.push_back(
                {fmt::format("{}, acceleration time {} s", name, acceleration_time_s), model});
        }
    return all;
}

/// The robust solution of an arc as one section.
template <int Axes>
RobustSolution<Axes> solve_robust_whole(const std::vector<ArcEpoch<Axes>>& arc,
                                        const EstimationModel& model, double scale,
                                        const std::vector<StateVector<Axes>>& start,
                                        std::int64_t passes_allowed = robust_passes_allowed) {
    const std::vector<ArcSection> whole{{0, arc.size(), 0, arc.size()}};
    return solve_robust<Axes>(arc, model, scale, start, whole, passes_allowed);
}

/// Sets jerk factors of quiet, hard and moderate motion in turn, every 150 epochs.
template <int Axes>
void change_motion(std::vector<ArcEpoch<Axes>>& arc) {
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k].jerk_factor = k % 150 < 90 ? 1.0 : k % 150 < 120 ? 12.0 : 2.5;
}

}  // namespace runcert::test
