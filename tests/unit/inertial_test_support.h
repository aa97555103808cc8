#pragma once

#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "simulation/inertial_run.h"

namespace runcert::test {

/// A salt lake and an oval: the lake with a mast of 5 m, 10 degrees of
/// roll and 2 of pitch; the oval with an antenna on the roof, from the middle of its first turn.
inline InertialRunSpec lake(ImuClass grade, std::uint64_t seed) {
    InertialRunSpec spec;
    spec.noise = imu_noise(grade);
    spec.seed = seed;
    return spec;
}
inline InertialRunSpec oval(ImuClass grade, std::uint64_t seed) {
    InertialRunSpec spec = lake(grade, seed);
    spec.course = InertialCourse::oval;
    spec.start_m = 1000.0;
    spec.roll_deg = 0.8;
    spec.pitch_deg = 0.4;
    spec.roll_hz = 1.0;
    spec.pitch_hz = 1.3;
    spec.antenna_m = {-0.5, 0.2, -1.2};
    return spec;
}

inline double attitude_error_deg(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth) {
    return rotation_vector(found * truth.transpose()).norm() * degrees_per_radian;
}

/// Chord speeds over 3 s of the reference point, and how they compare with the truth.
struct SpeedErrors {
    std::vector<double> errors_m_s;
    std::vector<double> sigmas_m_s;
    double best_error_m_s = 0.0;  ///< greatest measured less greatest true

    double inside() const {
        double count = 0.0;
        for (std::size_t i = 0; i < errors_m_s.size(); ++i)
            if (std::abs(errors_m_s[i]) <= 1.96 * sigmas_m_s[i]) count += 1.0;
        return count / static_cast<double>(errors_m_s.size());
    }
};

/// The truth of an epoch that the solution kept: leading ones may lie outside the samples.
inline std::size_t first_truth(const InertialRun& run, const InertialSolution& solution) {
    std::size_t first = 0;
    while (run.truth[first].time_s < solution.epochs[0].time_s - 1e-9)
        ++first;
    return first;
}

inline SpeedErrors speed_errors(const InertialRun& run, const InertialSolution& solution,
                                std::size_t window = 30, std::size_t every = 1,
                                std::size_t from = 0) {
    SpeedErrors result;
    const std::size_t first = first_truth(run, solution);
    double best = 0.0, true_best = 0.0;
    for (std::size_t s = from; s + window < solution.epochs.size(); s += every) {
        const std::size_t e = s + window;
        const double duration_s = solution.epochs[e].time_s - solution.epochs[s].time_s;
        const PointDisplacement moved = solution.displacement(s, e, CraftPoint::reference_point);
        const Eigen::Vector2d way = moved.enu_m.head<2>();
        const Eigen::Vector2d true_way =
            (run.truth[first + e].reference_point_m - run.truth[first + s].reference_point_m)
                .head<2>();
        const Eigen::Vector2d u = way.normalized();
        result.errors_m_s.push_back((way.norm() - true_way.norm()) / duration_s);
        result.sigmas_m_s.push_back(
            std::sqrt(u.dot(moved.covariance_m2.topLeftCorner<2, 2>() * u)) / duration_s);
        best = std::max(best, way.norm() / duration_s);
        true_best = std::max(true_best, true_way.norm() / duration_s);
    }
    result.best_error_m_s = best - true_best;
    return result;
}

}  // namespace runcert::test
