#include "inertial/judgement.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace runcert {
namespace {

constexpr double search_nis = 2.0;    ///< NIS/3 above which a start is doubted
constexpr double compared_s = 120.0;  ///< of motion, on which noise and offset are judged
/// By so much a time offset must raise the logarithm of the likelihood.
constexpr double asking_gain = 10.0;

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

struct FittedImuNoise {
    ImuNoise noise = {};
    double log_likelihood = 0.0;
    bool at_limit = false;  ///< the ladder of the motion or of the velocity ended first
};

/// The likeliest noise of an IMU: the data's own, its random walks multiplied by 1 to 50 (velocity)
/// and 1 to 8 (angle), with noise of 0 to 0.032 of the motion. Coordinates are searched in turn
/// over ladders of factors 2 to 2.5, twice; likelihoods are those of filters linear about one
/// trajectory.
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

/// Two minutes about the highest speed, on which to compare.
InertialData part_of(const InertialData& data, bool from_the_beginning) {
    std::size_t fastest = 0;
    double most_m_s = 0.0;
    for (std::size_t k = 0; k < data.fixes.size() && !from_the_beginning; ++k) {
        const double speed_m_s = velocity_of_positions(data.fixes, k).head<2>().norm();
        if (speed_m_s <= most_m_s) continue;
        most_m_s = speed_m_s;
        fastest = k;
    }
    const double middle_s = data.fixes[fastest].time_s;
    InertialData part = data;
    std::erase_if(part.fixes, [&](const PositionFix& fix) {
        return std::abs(fix.time_s - middle_s) > 0.5 * compared_s;
    });
    return part.fixes.size() < least_positions ? data : part;
}

/// The likeliest noise of a part about its own trajectory. That is found with the noise of a craft,
/// from which a wrong start recovers soonest.
Judged judge_part(InertialData part, InertialSetup setup, bool search) {
    const FoundStart start = find_start(part, setup, search);
    part.noise = setup.fit_noise ? on_a_craft(setup.noise) : setup.noise;
    const Passes passes = run_passes(part, start.prior);
    const std::vector<InertialNominal> about = passes.last.trajectory();
    double squares = 0.0;
    for (const PositionInnovation& innovation : passes.last.innovations)
        squares += innovation.whitened.squaredNorm();
    part.noise = setup.noise;
    const FittedImuNoise fitted =
        setup.fit_noise ? fit_imu_noise(part, start.prior, about)
                        : FittedImuNoise{setup.noise, passes.last.log_likelihood, false};
    setup.noise = fitted.noise;
    return {.setup = setup,
            .search = start.kind == StartMethod::search,
            .log_likelihood = fitted.log_likelihood,
            .nis = squares / (3.0 * static_cast<double>(about.size())),
            .noise_at_limit = fitted.at_limit};
}

}  // namespace

Judged judge(const InertialData& data, const InertialSetup& setup) {
    const InertialData part = part_of(data, setup.start.has_value());
    Judged best = judge_part(part, setup, false);
    if (best.nis > search_nis && !best.search && !setup.start) {
        const Judged searched = judge_part(part, setup, true);
        if (searched.log_likelihood > best.log_likelihood) best = searched;
    }
    if (setup.estimate_time_offset) return best;
    InertialSetup with_offset = setup;
    with_offset.estimate_time_offset = true;
    const Judged offset = judge_part(part, with_offset, best.search);
    return offset.log_likelihood > best.log_likelihood + asking_gain ? offset : best;
}

}  // namespace runcert
