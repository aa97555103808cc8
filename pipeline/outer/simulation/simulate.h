#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/simulation/simulation.h"
#include "simulation/inertial_run.h"

namespace runcert {

/// The run at one time.
struct RunState {
    double distance_m = 0.0;  ///< from where the craft was at time 0
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
    double jerk_m_s3 = 0.0;
};

/// The run of [DHD22], section "Simulated run", `time_s` after its beginning; before it (negative
/// times) too: v(t) = A / (1 + exp(-r (t - t0))), r = ln(A / v0 - 1) / t0. Failure as
/// `require_valid`. Rounding only: a distance to a few times 1e-16 of A (|t| + t0). Reproduces
/// table 2 of [DHD22] to its printed digits.
///
/// It takes exp and log from the C library, whose last bits differ between processor models. What
/// is written from it is rounded to 1e-6 m at the finest, a million times more.
RunState logistic_run(const LogisticRun& run, double time_s);

/// Whether a stretch holds that time: `from_s` belongs to it, `to_s` does not.
template <class Stretch>
bool contains(const Stretch& stretch, double time_s) {
    return stretch.from_s <= time_s && time_s < stretch.to_s;
}

/// How a craft moves at one time on which the antenna moves against the point of the run; in east,
/// north, up.
struct CraftTruth {
    Eigen::Vector3d antenna_velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d antenna_acceleration_m_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference_point_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference_velocity_m_s = Eigen::Vector3d::Zero();
    EulerAngles attitude = {};
};

struct SimulatedEpoch {
    std::int64_t epoch = 0;    ///< from 1; gaps leave their numbers out of the recording
    std::int64_t time_ms = 0;  ///< from the beginning of the run
    RunState truth{};          ///< of the point that moves as the run says
    std::optional<CraftTruth> craft = std::nullopt;
    Eigen::Vector3d true_enu_m = Eigen::Vector3d::Zero();      ///< of the antenna
    Eigen::Vector3d measured_enu_m = Eigen::Vector3d::Zero();  ///< with error and faults, unrounded
    bool fixed = true;     ///< ambiguities fixed; otherwise float
    bool recorded = true;  ///< false inside a gap

    double time_s() const { return static_cast<double>(time_ms) / 1000.0; }
};

/// Where the run goes: a unit vector in east, north, up.
Eigen::Vector3d direction_of(const LogisticRun& run);

/// Simulates a recording: every epoch from 0 to the duration, both included, those inside gaps
/// too. The run stays in the plane of its origin (up is constant), so that its speed in east,
/// north, up is the logistic; with a craft, the antenna moves about it. The same spec gives the
/// same epochs. Each error is drawn at its place in one sequence whether used or not, so that to
/// change a sigma, a fault or the duration leaves the other draws as they were. Failure as
/// `require_valid(LogisticRun)`, and (at "simulation") where duration or rate is not positive, a
/// sigma is negative, or the correlation time is not positive.
std::vector<SimulatedEpoch> simulate(const SimulationSpec& spec);

/// What an IMU on the spec's craft measures during the run and a second more, with biases and noise
/// of those sizes; its times count from the beginning of the run, and are as late as the spec says.
/// Needs craft and imu. The epochs of `simulate` do not depend on the noise. Failure as `simulate`.
std::vector<ImuSample> simulate_imu(const SimulationSpec& spec, const ImuNoise& noise);

/// Where the point of the run is at every step of the simulator, and how the craft moves there.
/// Needs craft.
std::vector<InertialTruth> course_of(const SimulationSpec& spec);

/// Speeds of a wheel of the craft (m/s), one for each epoch: with noise, never negative, and
/// divided by their scale.
std::vector<double> simulate_wheel(const SimulatedWheel& wheel, std::uint64_t seed,
                                   std::span<const SimulatedEpoch> epochs);

}  // namespace runcert
