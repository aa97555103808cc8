#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

// What the programs that are measured beside one another have in common: the positions that they
// smooth, read from the same file, and the smoothed states that they write to be compared. Native
// doubles, so that Octave (fread) and numpy (fromfile) read them as fast as C++.

namespace runcert::comparison {

/// One measured position (m: east, north, up) and its covariance (m^2).
struct MeasuredPosition {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// How it stands in the file.
inline constexpr std::size_t doubles_per_epoch = 9;  ///< E, N, U, EE, EN, EU, NN, NU, UU

/// Time between two epochs, s: 20 Hz.
inline constexpr double step_s = 0.05;

/// Root spectral density of the jerk that all programs smooth with, m s^-2.5.
inline constexpr double jerk_density = 1.0;

/// What a smoothed epoch says: means and standard deviations of position (m) and velocity (m/s).
struct SmoothedPoint {
    Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Zero();
};

/// The whole file. Failure where its length is not that of whole epochs, or it holds none.
std::vector<MeasuredPosition> read_positions(const std::filesystem::path& file);

/// Writes the point of every `every`th epoch, from the first on: 12 doubles, means first.
void write_points(const std::filesystem::path& file, std::size_t epochs, std::size_t every,
                  const std::function<SmoothedPoint(std::size_t epoch)>& point_of);

/// Seconds that a call takes, on the monotonic clock.
double seconds_of(const std::function<void()>& call);

/// What every program is told.
struct Arguments {
    std::filesystem::path data;
    std::filesystem::path result;
    std::size_t every = 1;
};

/// Reads --data, --result and --every, runs the program on them, prints as one line of
/// JSON what it returns; the exit status: 0, or 2 where something failed, which is said.
int run_program(int argc, char** argv,
                const std::function<nlohmann::ordered_json(const Arguments&)>& program);

}  // namespace runcert::comparison
