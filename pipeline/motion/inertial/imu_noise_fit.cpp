#include "inertial/imu_noise_fit.h"

#include <array>
#include <cmath>

namespace runcert {
namespace {

constexpr std::array motion_ladder{0.0, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032};
constexpr std::array velocity_ladder{1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
constexpr std::array angle_ladder{1.0, 2.0, 4.0, 8.0};

/// Where on the three ladders.
struct Rungs {
    std::array<std::size_t, 3> at{};

    ImuNoise of(ImuNoise noise) const {
        noise.motion_sqrt_s = std::hypot(noise.motion_sqrt_s, motion_ladder[at[0]]);
        noise.velocity_walk_m_s_sqrt_s *= velocity_ladder[at[1]];
        noise.angle_walk_rad_sqrt_s *= angle_ladder[at[2]];
        return noise;
    }
};

}  // namespace

FittedImuNoise fit_imu_noise(InertialData data, const InertialPrior& prior,
                             std::span<const InertialNominal> about) {
    const ImuNoise own = data.noise;
    const auto likelihood = [&](const Rungs& rungs) {
        data.noise = rungs.of(own);
        return filter_forwards(data, prior, about, about.size()).log_likelihood;
    };
    constexpr std::array sizes{motion_ladder.size(), velocity_ladder.size(), angle_ladder.size()};
    Rungs best;
    double greatest = likelihood(best);
    // Up each ladder for as long as it is likelier, then down.
    const auto climb = [&](std::size_t ladder, bool up) {
        bool moved = false;
        while (up ? best.at[ladder] + 1 < sizes[ladder] : best.at[ladder] > 0) {
            Rungs next = best;
            up ? ++next.at[ladder] : --next.at[ladder];
            const double found = likelihood(next);
            if (!(found > greatest)) break;
            greatest = found;
            best = next;
            moved = true;
        }
        return moved;
    };
    for (int round = 0; round < 2; ++round) {
        bool moved = false;
        for (std::size_t ladder = 0; ladder < sizes.size(); ++ladder)
            moved = climb(ladder, true) || climb(ladder, false) || moved;
        if (!moved) break;
    }
    // The angle's ladder adds little beside the motion's.
    const bool at_limit = best.at[0] + 1 == sizes[0] || best.at[1] + 1 == sizes[1];
    return {.noise = best.of(own), .log_likelihood = greatest, .at_limit = at_limit};
}

}  // namespace runcert
