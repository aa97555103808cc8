#include "satellites/point_solution.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "satellites/troposphere.h"

namespace runcert {
namespace {

constexpr int most_systems = 7;
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 + most_systems, 1>;
using Normals =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 + most_systems, 3 + most_systems>;

/// Assigns an unknown to the clock of each system, in order of appearance.
struct Clocks {
    std::array<int, most_systems> unknown{};
    int count = 0;

    explicit Clocks(std::span<const CodeMeasurement> measurements) {
        unknown.fill(-1);
        for (const CodeMeasurement& each : measurements) {
            int& mine = unknown[static_cast<std::size_t>(each.system)];
            if (mine < 0) mine = 3 + count++;
        }
    }
    int of(SatelliteSystem system) const { return unknown[static_cast<std::size_t>(system)]; }
};

}  // namespace

std::optional<PointSolution> point_solution(std::span<const CodeMeasurement> measurements,
                                            const Eigen::Vector3d& start_m) {
    const Clocks clocks(measurements);
    const int size = 3 + clocks.count;
    if (std::ssize(measurements) < size || clocks.count == 0) return std::nullopt;
    Unknowns state = Unknowns::Zero(size);
    state.head<3>() = start_m;
    for (int step = 0; step < 12; ++step) {
        const bool near_earth = state.head<3>().norm() > 5e6;
        // Starting from the Earth's centre, the first iterations omit what depends on the place.
        const ReceiverPosition receiver =
            near_earth ? receiver_position(state.head<3>())
                       : ReceiverPosition{.position_m = state.head<3>(),
                                          .enu_from_ecef = Eigen::Matrix3d::Zero()};
        Normals normals = Normals::Zero(size, size);
        Unknowns right = Unknowns::Zero(size);
        for (const CodeMeasurement& each : measurements) {
            const LineOfSight sight = line_of_sight(each.satellite_m, receiver);
            double weight = 1.0;
            double modelled_m = sight.range_m + state[clocks.of(each.system)];
            if (near_earth) {
                const double sine = std::max(sight.sine_of_elevation, 0.05);
                weight = sine * sine;
                modelled_m += troposphere_m(receiver.height_m, sine);
            }
            Unknowns row = Unknowns::Zero(size);
            row.head<3>() = -sight.direction;
            row[clocks.of(each.system)] = 1.0;
            normals.noalias() += weight * row * row.transpose();
            right += weight * (each.pseudorange_m - modelled_m) * row;
        }
        const Eigen::LDLT<Normals> solver(normals);
        if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
        const Unknowns change = solver.solve(right);
        state += change;
        if (!state.allFinite() || state.head<3>().norm() > 1e9) return std::nullopt;
        if (near_earth && change.head<3>().norm() < 1e-4)
            return PointSolution{.position_m = state.head<3>(),
                                 .clock_m = state[3],
                                 .satellites = measurements.size()};
    }
    return std::nullopt;
}

}  // namespace runcert
