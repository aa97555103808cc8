#include "inertial/inertial_smoother.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/statistics.h"
#include "inertial/alignment.h"
#include "inertial/imu_noise_fit.h"
#include "inertial/inertial_filter.h"
#include "inertial/joint_covariance.h"
#include "inertial/solution.h"

namespace runcert {
namespace {

constexpr std::size_t least_positions = 10;
/// About each axis the attitude may turn by the greater of these in the last pass.
constexpr double settled_rad = 1e-3;
constexpr double settled_sigmas = 0.1;
constexpr int most_passes = 12;
constexpr double search_nis = 2.0;    ///< NIS/3 above which a start is doubted
constexpr double compared_s = 120.0;  ///< of motion, on which noise and offset are judged
/// By so much a time offset must raise the logarithm of the likelihood.
constexpr double asking_gain = 10.0;
/// Samples must reach so far beyond the positions for a time offset to be found.
constexpr double offset_room_s = 0.5;

[[noreturn]] void refuse_fix(const PositionFix& fix, std::string what, std::string remedy) {
    throw Failure(fmt::format("positions, time {:.3f} s", fix.time_s), std::move(what),
                  std::move(remedy));
}

/// The positions that the samples reach, their covariances no smaller than the floors.
std::vector<PositionFix> usable(std::span<const PositionFix> fixes, const SampleReader& reader,
                                const InertialSetup& setup) {
    std::vector<PositionFix> kept;
    kept.reserve(fixes.size());
    const Eigen::Vector3d least(setup.least_horizontal_m, setup.least_horizontal_m,
                                setup.least_vertical_m);
    for (std::size_t k = 0; k < fixes.size(); ++k) {
        PositionFix fix = fixes[k];
        if (!std::isfinite(fix.time_s) || !fix.enu_m.allFinite() ||
            !fix.covariance_m2.allFinite() || !(fix.covariance_m2.diagonal().minCoeff() >= 0.0))
            refuse_fix(fix, "a position or its covariance is not a finite number",
                       "Leave the position out");
        if (k > 0 && !(fix.time_s > fixes[k - 1].time_s))
            refuse_fix(fix, "the time is not after that of the position before",
                       "Order the positions by time");
        const double at_s = fix.time_s + setup.time_offset_s;
        if (at_s < reader.begin_s() + offset_room_s || at_s > reader.end_s() - offset_room_s)
            continue;
        fix.covariance_m2.diagonal() =
            fix.covariance_m2.diagonal().cwiseMax(least.cwiseProduct(least));
        kept.push_back(fix);
    }
    if (kept.size() < least_positions)
        throw Failure(
            "positions",
            fmt::format("{} positions lie within the IMU's samples, {:.1f} to {:.1f} s",
                        kept.size(), reader.begin_s(), reader.end_s()),
            fmt::format("At least {} are needed. Check the IMU's clock", least_positions));
    return kept;
}

/// The passes of one start.
template <int N>
struct Passes {
    InertialPass<N> last;
    int count = 0;
    double turned = 0.0;  ///< by the last pass (`turned_by`)
};

/// The greatest turn of the attitude by the last pass, in units of what it may turn.
template <int N>
double turned_by(const InertialPass<N>& pass) {
    double most = 0.0;
    for (std::size_t k = 0; k < pass.estimated.size(); ++k)
        for (int axis = 0; axis < 3; ++axis) {
            const double sigma = std::sqrt(pass.covariance[k](axis, axis));
            const double turned = std::abs(pass.estimated[k](error_state::attitude + axis));
            most = std::max(most, turned / std::max(settled_rad, settled_sigmas * sigma));
        }
    return most;
}

template <int N>
Passes<N> run_passes(const InertialData& data, const InertialPrior& prior) {
    Passes<N> passes;
    std::vector<InertialNominal> about;
    const std::size_t count = data.fixes.size();
    while (passes.count < most_passes) {
        passes.last = {};  // its memory is free before that of the next is taken
        passes.last = filter_forwards<N>(data, prior, about, count);
        smooth_backwards<N>(passes.last, data);
        ++passes.count;
        passes.turned = turned_by(passes.last);
        if (passes.turned < 1.0) break;
        if (passes.count == most_passes) break;
        about.resize(count);
        for (std::size_t k = 0; k < count; ++k)
            about[k] = passes.last.solution(k);
        // One time offset for all epochs, as it is one constant.
        for (InertialNominal& each : about)
            each.time_offset_s = about.back().time_offset_s;
    }
    return passes;
}

template <int N>
InertialSolution solve(const InertialData& data, const FoundStart& start,
                       const InertialSetup& setup) {
    Passes<N> passes = run_passes<N>(data, start.prior);
    InertialSolution solution = solution_of<N>(std::move(passes.last), data, setup, passes.turned);
    solution.passes = passes.count;
    solution.start = start.kind;
    return solution;
}

InertialSolution solve(const InertialData& data, const FoundStart& start,
                       const InertialSetup& setup) {
    return setup.estimate_antenna || setup.estimate_time_offset
               ? solve<error_state::full>(data, start, setup)
               : solve<error_state::plain>(data, start, setup);
}

/// Solves from the start that the data give, or else a searched one.
InertialSolution solve_from_start(const InertialData& data, const InertialSetup& setup,
                                  bool search) {
    const auto start = search ? std::nullopt : find_start(data, setup);
    return solve(data, start ? *start : search_start(data, setup), setup);
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

/// How a recording is to be solved.
struct Judged {
    InertialSetup setup;
    bool search = false;
    double log_likelihood = 0.0;
    double nis = 0.0;
    bool noise_at_limit = false;
};

/// The likeliest noise of a part about its own trajectory. That is found with the noise of a craft,
/// from which a wrong start recovers soonest.
template <int N>
Judged judge(InertialData part, InertialSetup setup, bool search) {
    const auto found = search ? std::nullopt : find_start(part, setup);
    const FoundStart start = found ? *found : search_start(part, setup);
    part.noise = setup.fit_noise ? on_a_craft(setup.noise) : setup.noise;
    const Passes<N> passes = run_passes<N>(part, start.prior);
    std::vector<InertialNominal> about(part.fixes.size());
    double squares = 0.0;
    for (std::size_t k = 0; k < about.size(); ++k) {
        about[k] = passes.last.solution(k);
        squares += passes.last.innovations[k].whitened.squaredNorm();
    }
    for (InertialNominal& each : about)
        each.time_offset_s = about.back().time_offset_s;
    part.noise = setup.noise;
    const FittedImuNoise fitted =
        setup.fit_noise ? fit_imu_noise<N>(part, start.prior, about)
                        : FittedImuNoise{setup.noise, passes.last.log_likelihood, false};
    setup.noise = fitted.noise;
    return {.setup = setup,
            .search = start.kind == InertialStart::search,
            .log_likelihood = fitted.log_likelihood,
            .nis = squares / (3.0 * static_cast<double>(about.size())),
            .noise_at_limit = fitted.at_limit};
}

Judged judge(const InertialData& part, const InertialSetup& setup, bool search) {
    return setup.estimate_antenna || setup.estimate_time_offset
               ? judge<error_state::full>(part, setup, search)
               : judge<error_state::plain>(part, setup, search);
}

/// Start, noise and time offset by the likelihood of a part.
Judged judge(const InertialData& part, const InertialSetup& setup) {
    Judged best = judge(part, setup, false);
    if (best.nis > search_nis && !best.search && !setup.start) {
        const Judged searched = judge(part, setup, true);
        if (searched.log_likelihood > best.log_likelihood) best = searched;
    }
    if (setup.estimate_time_offset) return best;
    InertialSetup with_offset = setup;
    with_offset.estimate_time_offset = true;
    const Judged offset = judge(part, with_offset, best.search);
    return offset.log_likelihood > best.log_likelihood + asking_gain ? offset : best;
}

InertialData data_of(std::span<const ImuSample> samples, std::span<const PositionFix> fixes,
                     const InertialSetup& setup) {
    const SampleReader reader(samples);
    return {.samples = samples,
            .fixes = usable(fixes, reader, setup),
            .earth = EarthFrame(setup.origin),
            .noise = setup.noise,
            .position_error = setup.position_error};
}

}  // namespace

InertialSolution smooth_inertial(std::span<const ImuSample> samples,
                                 std::span<const PositionFix> fixes, const InertialSetup& setup) {
    InertialData data = data_of(samples, fixes, setup);
    const Judged judged = judge(part_of(data, setup.start.has_value()), setup);
    data.noise = judged.setup.noise;
    InertialSolution solution = solve_from_start(data, judged.setup, judged.search);
    solution.time_offset_asked_by_innovations =
        judged.setup.estimate_time_offset && !setup.estimate_time_offset;
    if (judged.noise_at_limit)
        solution.consistency.doubts.push_back({InertialFinding::noise_large,
                                               judged.setup.noise.motion_sqrt_s,
                                               setup.noise.motion_sqrt_s});
    return solution;
}

std::vector<FilteredAttitude> filter_attitude(std::span<const ImuSample> samples,
                                              std::span<const PositionFix> fixes,
                                              const InertialSetup& setup) {
    if (!setup.start) throw Failure("attitude", "there is no start to filter from", "Give one");
    const InertialData data = data_of(samples, fixes, setup);
    const auto pass = filter_forwards<error_state::plain>(data, find_start(data, setup)->prior, {},
                                                          data.fixes.size());
    std::vector<FilteredAttitude> attitudes;
    attitudes.reserve(data.fixes.size());
    for (std::size_t k = 0; k < data.fixes.size(); ++k)
        attitudes.push_back({.time_s = data.fixes[k].time_s,
                             .enu_from_body = pass.nominal[k].state.enu_from_body,
                             .covariance_rad2 = pass.covariance[k].topLeftCorner<3, 3>(),
                             .nis = pass.innovations[k].whitened.squaredNorm()});
    return attitudes;
}

}  // namespace runcert
