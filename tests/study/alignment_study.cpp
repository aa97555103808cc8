#include "alignment_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/random.h"
#include "inertial/alignment.h"
#include "inertial/surface_attitude.h"
#include "inertial_test_support.h"

namespace runcert {
namespace {

constexpr double rad = radians_per_degree;
constexpr double converged_deg = 1.0;
constexpr double allowed_s = 100.0;
constexpr double duration_s = 110.0;
constexpr double triangle_m = 10.0;
constexpr double surveyed_sigma_m = 0.02;

EulerAngles degrees(double roll, double pitch, double heading) {
    return {.roll = rad * roll, .pitch = rad * pitch, .heading = rad * heading};
}

const EulerAngles stiff = degrees(1.0, 1.0, 1.5);

StartAttitude start_with(const EulerAngles& angles, const EulerAngles& sigma) {
    const Eigen::Matrix3d c = rotation_of(angles);
    return {c, attitude_covariance(c, sigma)};
}

Eigen::Vector3d drawn(RandomGenerator& random) {
    Eigen::Vector3d deviates;
    for (double& deviate : deviates)
        deviate = random.normal();
    return deviates;
}

/// The normal of the ground as surveyed: by a right-angled triangle along the course and across
/// it, the heights of whose vertices err.
Eigen::Vector3d surveyed(const InertialTruth& truth, double vertex_sigma_m,
                         RandomGenerator& random) {
    const Eigen::Vector3d heights = vertex_sigma_m * drawn(random);
    const Eigen::Vector2d ahead = truth.imu.velocity_m_s.head<2>().normalized();
    const Eigen::Vector2d right(ahead.y(), -ahead.x());
    const Eigen::Vector3d& normal = truth.ground_normal;
    // Slopes towards east and north.
    const Eigen::Vector2d slope = -normal.head<2>() / normal.z() +
                                  (heights.y() - heights.x()) / triangle_m * ahead +
                                  (heights.z() - heights.x()) / triangle_m * right;
    return Eigen::Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
}

/// A recording of which the filter takes the positions from `first` on.
struct StudiedRun {
    InertialRun run;
    InertialSetup setup;
    std::size_t first = 0;

    const InertialTruth& start() const { return run.truth[first]; }
};

StudiedRun simulated(const AlignmentCell& cell, int start, int starts, std::uint64_t seed) {
    InertialRunSpec spec = cell.spec;
    spec.seed = seed * 1'000'003 + static_cast<std::uint64_t>(start);
    spec.start_m += cell.spread_m * start / starts;
    spec.duration_s = duration_s + 1.0;
    StudiedRun studied{.run = simulate_inertial(spec), .setup = setup_of(spec)};
    studied.setup.position_error = spec.position_error;
    while (studied.run.truth[studied.first].time_s < 0.5)
        ++studied.first;
    return studied;
}

StartAttitude start_of(AlignmentStart start, const AlignmentCell& cell, const InertialTruth& truth,
                       const EulerAngles& lean, RandomGenerator& random) {
    const Eigen::Vector3d velocity =
        truth.imu.velocity_m_s + cell.velocity_sigma_m_s * drawn(random);
    switch (start) {
        case AlignmentStart::previous: {
            EulerAngles angles = euler_angles(truth.imu.enu_from_body);
            const EulerAngles sigma = degrees(5.0, 5.0, 12.0);
            angles.roll += sigma.roll * random.normal();
            angles.pitch += sigma.pitch * random.normal();
            angles.heading += sigma.heading * random.normal();
            return start_with(angles, sigma);
        }
        case AlignmentStart::blind:
            return start_with({.heading = 2.0 * std::numbers::pi * random.uniform()},
                              degrees(10.0, 8.0, 100.0));
        case AlignmentStart::gps_heading:
            return start_with({.heading = std::atan2(velocity.x(), velocity.y())},
                              degrees(9.0, 4.0, 3.0));
        case AlignmentStart::track_model:
            break;
    }
    const SurfaceMotion motion{surveyed(truth, surveyed_sigma_m, random), velocity};
    const Eigen::Matrix3d attitude = attitude_on_surface(motion).value();
    EulerAngles sigma = lean;
    sigma.heading = std::hypot(lean.heading, std::atan2(cell.velocity_sigma_m_s, velocity.norm()));
    return {attitude, attitude_covariance(attitude, sigma)};
}

/// The truth turned by an error about one axis.
StartAttitude wrong_start(const InertialTruth& truth, double error_deg, int start) {
    const bool heading_alone = error_deg > 40.0;
    const int axis = heading_alone ? 2 : start % 3;
    const double sign = start / 3 % 2 == 0 ? 1.0 : -1.0;
    EulerAngles angles = euler_angles(truth.imu.enu_from_body);
    (axis == 0 ? angles.roll : axis == 1 ? angles.pitch : angles.heading) += sign * error_deg * rad;
    const double sigma_deg = std::max(1.0, error_deg);
    return start_with(angles, heading_alone ? degrees(5.0, 5.0, sigma_deg)
                                            : degrees(sigma_deg, sigma_deg, sigma_deg));
}

Alignment align(const StudiedRun& studied, const StartAttitude& start) {
    InertialSetup setup = studied.setup;
    setup.start = start;
    InertialData data{.samples = studied.run.samples,
                      .fixes = {},
                      .earth = EarthFrame(setup.origin),
                      .noise = setup.noise,
                      .position_error = setup.position_error};
    // The samples reach half a second beyond the positions, as a smoother asks.
    for (std::size_t k = studied.first; k < studied.run.fixes.size(); ++k)
        if (studied.run.fixes[k].time_s <= studied.run.samples.back().time_s - 0.5)
            data.fixes.push_back(studied.run.fixes[k]);
    const std::size_t count = data.fixes.size();
    const InertialPass pass = filter_forwards(data, find_start(data, setup).prior, {}, count);
    const double step_s = data.fixes[1].time_s - data.fixes[0].time_s;
    Alignment found{.initial_error_deg = test::attitude_error_deg(
                        start.enu_from_body, studied.start().imu.enu_from_body)};
    double since_s = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const double time_s = data.fixes[k].time_s - data.fixes[0].time_s;
        const double error_deg =
            test::attitude_error_deg(pass.nominal[k].state.enu_from_body,
                                     studied.run.truth[studied.first + k].imu.enu_from_body);
        found.nis += pass.innovations[k].whitened.squaredNorm() / 3.0 / static_cast<double>(count);
        if (error_deg >= converged_deg) since_s = time_s + step_s;
        if (found.stated_s ||
            std::sqrt(pass.covariance[k].topLeftCorner<3, 3>().trace()) >= converged_deg * rad)
            continue;
        found.stated_s = time_s;
        found.error_when_stated_deg = error_deg;
    }
    if (since_s <= allowed_s) found.true_s = since_s;
    return found;
}

AlignmentCell on_the_oval(std::string name) {
    constexpr double lap_m = 600.0 + std::numbers::pi * 320.0 + 150.0;
    return {.name = std::move(name),
            .spec = test::oval(ImuClass::tactical, 0),
            .spread_m = lap_m,
            .lean = stiff};
}

}  // namespace

std::vector<AlignmentCell> alignment_cells() {
    AlignmentCell early = on_the_oval("oval, tactical, 1 Hz as in 2003");
    early.spec.position_hz = 1;
    early.spec.white_horizontal_m = early.spec.white_vertical_m = 0.3;
    early.spec.position_error = {.horizontal_m = 1.0, .vertical_m = 1.0, .time_s = 60.0};
    early.velocity_sigma_m_s = 0.3;
    AlignmentCell lake{.name = "salt lake, MEMS, 10 Hz post-processed",
                       .spec = test::lake(ImuClass::mems, 0),
                       .lean = degrees(8.0, 2.0, 3.0)};
    return {early, on_the_oval("oval, tactical, 10 Hz post-processed"), lake};
}

std::string alignment_start_name(AlignmentStart start) {
    switch (start) {
        case AlignmentStart::previous:
            return "previous";
        case AlignmentStart::blind:
            return "blind";
        case AlignmentStart::gps_heading:
            return "GPS heading";
        case AlignmentStart::track_model:
            break;
    }
    return "track model";
}

AlignmentSummary summarise(const std::vector<Alignment>& runs) {
    AlignmentSummary summary{.runs = static_cast<int>(runs.size())};
    std::vector<double> initial, stated, errors, converged;
    for (const Alignment& one : runs) {
        initial.push_back(one.initial_error_deg);
        if (one.stated_s) {
            stated.push_back(*one.stated_s);
            errors.push_back(one.error_when_stated_deg);
        }
        if (one.true_s) {
            converged.push_back(*one.true_s);
            continue;
        }
        ++summary.failed;
        if (one.nis <= 2.0) ++summary.failed_unseen;
    }
    const auto moments = [](const std::vector<double>& values, double& average, double& sd) {
        if (!values.empty()) average = mean(values);
        if (values.size() > 1) sd = standard_deviation(values);
    };
    summary.initial_error_deg = mean(initial);
    moments(stated, summary.stated_s, summary.stated_sd_s);
    moments(converged, summary.true_s, summary.true_sd_s);
    if (!errors.empty()) {
        summary.error_median_deg = median(errors);
        summary.error_most_deg = std::ranges::max(errors);
    }
    if (!converged.empty()) summary.true_most_s = std::ranges::max(converged);
    return summary;
}

AlignmentStudy study_alignment(const AlignmentCell& cell, const AlignmentOptions& options) {
    const std::uint64_t seed = options.seed;
    const bool leans = cell.lean.roll > stiff.roll;
    AlignmentStudy study{.cell = cell.name};
    study.by_start.resize(std::size(alignment_starts));
    study.by_error.resize(std::size(alignment_errors_deg));
    struct OfOneStart {
        std::vector<Alignment> by_start, by_error, overconfident;
    };
    const auto all = results_of(options.starts, options.threads, [&](std::int64_t i) {
        const int start = static_cast<int>(i);
        const StudiedRun studied = simulated(cell, start, options.starts, seed);
        const auto draws_of = [&](std::size_t method) {
            return RandomGenerator((seed * 1'000'003 + static_cast<std::uint64_t>(i)) * 8 + method);
        };
        OfOneStart found;
        for (const AlignmentStart method : alignment_starts) {
            RandomGenerator random = draws_of(static_cast<std::size_t>(method));
            found.by_start.push_back(
                align(studied, start_of(method, cell, studied.start(), cell.lean, random)));
        }
        for (const double error_deg : alignment_errors_deg) {
            if (!options.errors) break;
            found.by_error.push_back(
                align(studied, wrong_start(studied.start(), error_deg, start)));
        }
        if (leans) {
            RandomGenerator random =
                draws_of(static_cast<std::size_t>(AlignmentStart::track_model));
            found.overconfident.push_back(align(studied, start_of(AlignmentStart::track_model, cell,
                                                                  studied.start(), stiff, random)));
        }
        return found;
    });
    for (const OfOneStart& one : all) {
        for (std::size_t i = 0; i < one.by_start.size(); ++i)
            study.by_start[i].push_back(one.by_start[i]);
        for (std::size_t i = 0; i < one.by_error.size(); ++i)
            study.by_error[i].push_back(one.by_error[i]);
        std::ranges::copy(one.overconfident, std::back_inserter(study.overconfident));
    }
    return study;
}

SurfaceAccuracy study_surface(double vertex_sigma_m, double velocity_sigma_m_s, int runs,
                              std::uint64_t seed) {
    SurfaceAccuracy accuracy{.vertex_sigma_m = vertex_sigma_m,
                             .velocity_sigma_m_s = velocity_sigma_m_s};
    std::vector<double> errors_deg[3];
    for (int i = 0; i < runs; ++i) {
        InertialRunSpec spec =
            test::oval(ImuClass::tactical, seed * 1'000'003 + static_cast<std::uint64_t>(i));
        const InertialRun run = simulate_inertial(spec);
        RandomGenerator random(spec.seed);
        for (std::size_t k = 0; k < run.truth.size(); k += 2) {  // 14 m: the next triangle
            const InertialTruth& truth = run.truth[k];
            const auto found =
                attitude_on_surface({surveyed(truth, vertex_sigma_m, random),
                                     truth.imu.velocity_m_s + velocity_sigma_m_s * drawn(random)});
            const EulerAngles by_surface = euler_angles(found.value());
            const EulerAngles is = euler_angles(truth.imu.enu_from_body);
            const double differences[]{by_surface.roll - is.roll, by_surface.pitch - is.pitch,
                                       by_surface.heading - is.heading};
            for (std::size_t axis = 0; axis < 3; ++axis)
                errors_deg[axis].push_back(
                    std::remainder(differences[axis], 2.0 * std::numbers::pi) / rad);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        accuracy.mean_deg(axis) = mean(errors_deg[axis]);
        accuracy.sd_deg(axis) = standard_deviation(errors_deg[axis]);
    }
    return accuracy;
}

}  // namespace runcert
