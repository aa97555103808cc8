#include "inertial/inertial_smoother.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/statistics.h"
#include "inertial/joint_covariance.h"
#include "inertial/judgement.h"
#include "inertial/solution.h"

namespace runcert {
namespace {

/// Samples must reach so far beyond the positions for a time offset to be found.
constexpr double offset_room_s = 0.5;

std::string location_text(const PositionFix& fix) {
    return fmt::format("positions, time {:.3f} s", fix.time_s);
}

bool is_reached(const PositionFix& fix, const SampleReader& reader, const InertialSetup& setup) {
    const double at_s = fix.time_s + setup.time_offset_s;
    return at_s >= reader.begin_s() + offset_room_s && at_s <= reader.end_s() - offset_room_s;
}

/// The positions that the samples reach, their covariances no smaller than the floors.
std::vector<PositionFix> usable(std::span<const PositionFix> fixes, const SampleReader& reader,
                                const InertialSetup& setup) {
    std::vector<PositionFix> usable;
    usable.reserve(fixes.size());
    const Eigen::Vector3d least(setup.least_horizontal_m, setup.least_horizontal_m,
                                setup.least_vertical_m);
    for (std::size_t k = 0; k < fixes.size(); ++k) {
        PositionFix fix = fixes[k];
        if (!std::isfinite(fix.time_s) || !fix.enu_m.allFinite() ||
            !fix.covariance_m2.allFinite() || !(fix.covariance_m2.diagonal().minCoeff() >= 0.0))
            throw Failure(location_text(fix), "a position or its covariance is not a finite number",
                          "Leave the position out");
        if (k > 0 && !(fix.time_s > fixes[k - 1].time_s))
            throw Failure(location_text(fix), "the time is not after that of the position before",
                          "Order the positions by time");
        if (!is_reached(fix, reader, setup)) continue;
        fix.covariance_m2.diagonal() =
            fix.covariance_m2.diagonal().cwiseMax(least.cwiseProduct(least));
        usable.push_back(fix);
    }
    if (usable.size() < least_positions)
        throw Failure(
            "positions",
            fmt::format("{} positions lie within the IMU's samples, {:.1f} to {:.1f} s",
                        usable.size(), reader.begin_s(), reader.end_s()),
            fmt::format("At least {} are needed. Check the IMU's clock", least_positions));
    return usable;
}

/// The trajectory found before, about which to be linear.
std::vector<InertialNominal> found_before(const InertialData& data, const InertialSetup& setup) {
    std::vector<InertialNominal> all;
    if (!setup.before) return all;
    if (setup.before->states.size() != data.fixes.size())
        throw Failure(
            "attitude",
            fmt::format("the solution found before has {} epochs, the IMU's samples reach "
                        "{} positions",
                        setup.before->states.size(), data.fixes.size()),
            "It belongs to other positions: run the stage smooth again");
    all.reserve(data.fixes.size());
    for (const ImuState& state : setup.before->states)
        all.push_back({.state = state.motion,
                       .bias = state.bias,
                       .antenna_m = setup.antenna_m,
                       .time_offset_s = setup.before->time_offset_s});
    return all;
}

InertialSolution solve(const InertialData& data, const FoundStart& start,
                       const InertialSetup& setup) {
    Passes passes = run_passes(data, start.prior, found_before(data, setup));
    InertialSolution solution = solution_of(std::move(passes.last), data, setup, passes.turned);
    solution.passes = passes.count;
    solution.start = start.kind;
    solution.start_attitude = {start.prior.nominal.state.enu_from_body,
                               start.prior.covariance.topLeftCorner<3, 3>()};
    return solution;
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

std::size_t positions_within(std::span<const ImuSample> samples, std::span<const PositionFix> fixes,
                             const InertialSetup& setup) {
    const SampleReader reader(samples);
    return static_cast<std::size_t>(std::ranges::count_if(
        fixes, [&](const PositionFix& fix) { return is_reached(fix, reader, setup); }));
}

InertialSolution smooth_inertial(std::span<const ImuSample> samples,
                                 std::span<const PositionFix> fixes, const InertialSetup& setup) {
    InertialData data = data_of(samples, fixes, setup);
    if (setup.before) return solve(data, find_start(data, setup, setup.before->searched), setup);
    const Judged judged = judge(data, setup);
    data.noise = judged.setup.noise;
    InertialSolution solution =
        solve(data, find_start(data, judged.setup, judged.search), judged.setup);
    solution.time_offset_asked_by_innovations =
        judged.setup.estimate_time_offset && !setup.estimate_time_offset;
    if (judged.noise_at_limit)
        solution.consistency.doubts.push_back({InertialFinding::noise_large,
                                               judged.setup.noise.motion_sqrt_s,
                                               setup.noise.motion_sqrt_s});
    if (!solution.consistency.consistent())
        solution.consistency.shaking = shaking_of(samples, [&](double time_s) {
            const auto at = std::ranges::lower_bound(
                data.fixes, time_s - judged.setup.time_offset_s, {}, &PositionFix::time_s);
            if (at == data.fixes.end()) return std::nan("");
            return velocity_of_positions(data.fixes,
                                         static_cast<std::size_t>(at - data.fixes.begin()))
                .head<2>()
                .norm();
        });
    return solution;
}

}  // namespace runcert
