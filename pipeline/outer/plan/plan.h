#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "store/process.h"

namespace runcert {

/// What is to be recorded with.
struct PlannedEquipment {
    std::int64_t rate_hz = 10;
    double accuracy_m = 0.02;  ///< standard deviation of a position, of each axis
    /// Standard deviation of each component of recorded velocities, where they are recorded.
    std::optional<double> velocities_m_s = {};
    /// Standard deviation of the speed of a wheel, where there is one.
    std::optional<double> wheel_m_s = {};
};

/// The run that is planned: from standing to that speed, straight, on a lake.
struct PlannedRun {
    std::string rule{};         ///< the profile's id
    std::string craft_class{};  ///< as in an attempt
    double record_m_s = 0.0;
    double speed_m_s = 0.0;                                      ///< what it is hoped for
    std::filesystem::path programs = runcert::program_folder();  ///< where the stages' are
};

/// What the chain makes of a simulated attempt.
struct Prospect {
    std::optional<double> speed_m_s{};                 ///< certified; none where none could be
    std::optional<double> expanded_uncertainty_m_s{};  ///< of it, k = 2
    double required_speed_m_s = 0.0;
    /// The lowest speed that this uncertainty lets be accepted, above the required one.
    std::optional<double> margin_m_s{};
    bool proven = false;                   ///< the record is beaten by this speed
    std::string reason{};                  ///< the outcome in one sentence
    std::vector<std::string> not_met{};    ///< requirements, with why: "accuracy: 1.2 km/h ..."
    std::vector<std::string> to_attest{};  ///< "5 by judge"
};

/// The expanded uncertainty (k = 2) of the speed at one epoch by [DHD22] (24), from positions with
/// that standard deviation: 2 sigma / (sqrt(2) dt).
double formula_uncertainty_m_s(const PlannedEquipment& equipment);

/// Simulates an attempt with this equipment and runs the stages on it. Errors of positions are of
/// that size, a fifth of their variance white, the rest correlated over 1.5 s, as of the examples.
/// Failure where the rule's window is longer than a simulated run.
Prospect simulate_prospect(const PlannedEquipment& equipment, const PlannedRun& run,
                           std::int64_t seed);

/// How many attempts a plan simulates of each equipment.
inline constexpr int planned_attempts = 5;

/// The one whose uncertainty is the median of this many attempts; one that cannot be certified
/// where most of them cannot. It is proven where most of them are.
Prospect median_prospect(const PlannedEquipment& equipment, const PlannedRun& run, int attempts);

/// In words, what else would prove the record: of equipment that does, the coarsest positions and
/// the lowest rate, each alone; of equipment that does not, the coarsest positions that would, and
/// velocities good to 0.05 m/s where none are recorded.
std::vector<std::string> other_equipment(const PlannedEquipment& equipment, const PlannedRun& run,
                                         bool proves);

}  // namespace runcert
