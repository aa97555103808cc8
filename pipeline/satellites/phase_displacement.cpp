#include "satellites/phase_displacement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "satellites/troposphere.h"

namespace runcert {
namespace {

/// Elevations below this share one weight.
constexpr double least_sine = 0.05;

}  // namespace

double PhaseNoise::variance_m2(double sine_of_elevation, double interval_s) const {
    const double sine = std::max(sine_of_elevation, least_sine);
    const double slow_m = rate_m_s * interval_s / sine;
    return white_m * white_m * (1.0 + 1.0 / (sine * sine)) + slow_m * slow_m;
}

double systematic_rate_m_s(std::size_t satellites) {
    return satellites <= 6 ? 0.003 : 0.001;
}

std::optional<PhaseDisplacement> phase_displacement(std::span<const PhaseChange> changes,
                                                    const ReceiverPosition& receiver,
                                                    double interval_s, const PhaseNoise& noise) {
    const auto count = static_cast<Eigen::Index>(changes.size());
    if (count < 4 || count > most_phase_changes) return std::nullopt;
    // The terms that stay constant from iteration to iteration: all but the second range.
    PhaseVector known_m(count), sigma_m(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const PhaseChange& change = changes[static_cast<std::size_t>(i)];
        const LineOfSight first = line_of_sight(change.satellite_m[0], receiver);
        known_m[i] =
            change.phase_m + change.clock_m[1] - change.clock_m[0] + first.range_m +
            troposphere_m(receiver.height_m, std::max(first.sine_of_elevation, least_sine));
        sigma_m[i] = std::sqrt(noise.variance_m2(first.sine_of_elevation, interval_s));
    }
    PhaseDisplacement result;
    Eigen::Vector4d state = Eigen::Vector4d::Zero();  // east, north, up, clock
    Eigen::Matrix4d normals;
    PhaseVector left_m(count);
    result.design.resize(count, 4);
    bool settled = false;
    for (int step = 0; step < 8 && !settled; ++step) {
        ReceiverPosition second = receiver;
        second.position_m += receiver.enu_from_ecef.transpose() * state.head<3>();
        second.height_m += state[2];
        for (Eigen::Index i = 0; i < count; ++i) {
            const LineOfSight sight =
                line_of_sight(changes[static_cast<std::size_t>(i)].satellite_m[1], second);
            const double delay_m =
                troposphere_m(second.height_m, std::max(sight.sine_of_elevation, least_sine));
            left_m[i] = known_m[i] - sight.range_m - delay_m - state[3];
            result.design.row(i).head<3>() =
                -(receiver.enu_from_ecef * sight.direction).transpose() / sigma_m[i];
            result.design(i, 3) = 1.0 / sigma_m[i];
        }
        normals.noalias() = result.design.transpose() * result.design;
        const Eigen::LDLT<Eigen::Matrix4d> solver(normals);
        const Eigen::Vector4d pivots = solver.vectorD();
        if (!(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) return std::nullopt;
        const Eigen::Vector4d change =
            solver.solve(result.design.transpose() * left_m.cwiseQuotient(sigma_m));
        state += change;
        if (!state.allFinite()) return std::nullopt;
        // What the next iteration would change is second order: below 0.1 um after one of 10 cm.
        settled = change.norm() < 1e-5;
        left_m -= result.design.cwiseProduct(sigma_m.replicate<1, 4>()) * change;
    }
    if (!settled) return std::nullopt;
    result.enu_m = state.head<3>();
    result.clock_m = state[3];
    result.covariance_m2 = normals.inverse().topLeftCorner<3, 3>();
    result.statistic = left_m.cwiseQuotient(sigma_m).squaredNorm();
    result.residuals_m = left_m;
    result.sigma_m = sigma_m;
    result.redundancy = static_cast<int>(count) - 4;
    return result;
}

}  // namespace runcert
