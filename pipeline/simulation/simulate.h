#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/angle.h"
#include "core/geodesy.h"
#include "core/gps_time.h"
#include "simulation/logistic_run.h"

namespace runcert {

/// Standard deviation of an error: of east and of north, each, and of up (m).
struct ErrorSigmas {
    double horizontal_m = 0.0;
    double vertical_m = 0.0;
};

/// One position that is off, the ones around it are not: a multipath spike.
struct OutlierFault {
    std::int64_t epoch = 1;  ///< from 1
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
};

/// Every position from a time on is off by the same: an ambiguity fixed to a wrong integer.
struct StepFault {
    double time_s = 0.0;
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
};

/// Every position drifts away from a time on, and stays where it is at another: ambiguities that a
/// solver has not yet found, or loses.
struct RampFault {
    double from_s = 0.0;
    double to_s = 0.0;
    Eigen::Vector3d enu_m_s = Eigen::Vector3d::Zero();
};

/// A stretch of time: `from_s` belongs to it, `to_s` does not.
struct TimeStretch {
    double from_s = 0.0;
    double to_s = 0.0;

    bool contains(double time_s) const { return from_s <= time_s && time_s < to_s; }
};

struct Faults {
    std::vector<OutlierFault> outliers;
    std::vector<StepFault> steps;
    std::vector<RampFault> ramps;
    std::vector<TimeStretch> gaps;         ///< nothing is recorded
    std::vector<TimeStretch> float_fixes;  ///< recorded with float ambiguities, not fixed ones
};

/// How the receiver writes down what it measured.
struct RecordingStyle {
    int decimals_m = 5;     ///< of metres; 0 to 5
    int decimals_deg = 11;  ///< of degrees; 5 to 11 (1e-11 degrees are a micrometre)
    bool with_up = true;    ///< in an engineering CRS, whether heights are recorded
    ErrorSigmas accuracy{.horizontal_m = 0.010, .vertical_m = 0.020};  ///< that it claims
};

/// Everything a simulated recording follows from.
struct SimulationSpec {
    LogisticRun run{};
    std::int64_t duration_ms = 45'000;
    std::int64_t interval_ms = 100;
    Angle bearing = Angle::from_degrees(45.0);  ///< of travel, clockwise from north
    Eigen::Vector3d start_enu_m = Eigen::Vector3d::Zero();

    /// Origin of the east, north, up that the run is in; without it they are engineering
    /// coordinates. The run stays in the plane (up is constant), so that the speed in this frame is
    /// the logistic.
    std::optional<Geodetic> place;
    std::optional<GpsTime> start;  ///< GPS time of time 0; whole milliseconds

    ErrorSigmas white{};              ///< independent from epoch to epoch
    ErrorSigmas correlated{};         ///< first-order Gauss-Markov, [YSM22]
    double correlation_time_s = 1.0;  ///< of that, tau
    std::uint64_t seed = 1;
    Faults faults{};
    RecordingStyle recording{};
};

struct SimulatedEpoch {
    std::int64_t epoch = 0;    ///< from 1; gaps leave their numbers out of the recording
    std::int64_t time_ms = 0;  ///< from the beginning of the run
    RunState truth{};
    Eigen::Vector3d true_enu_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d measured_enu_m = Eigen::Vector3d::Zero();  ///< with error and faults, unrounded
    bool fixed = true;     ///< ambiguities fixed; otherwise float
    bool recorded = true;  ///< false inside a gap

    double time_s() const { return static_cast<double>(time_ms) / 1000.0; }
};

/// Simulates a recording: every epoch from 0 to the duration, both included, those inside gaps
/// too. The same spec gives the same epochs. Each error is drawn at its place in one sequence
/// whether used or not, so that to change a sigma, a fault or the duration leaves the other draws
/// as they were. Failure as `require_valid(LogisticRun)`, and (at "simulation") where duration or
/// interval is not positive, a sigma is negative, or the correlation time is not positive.
std::vector<SimulatedEpoch> simulate(const SimulationSpec& spec);

}  // namespace runcert
