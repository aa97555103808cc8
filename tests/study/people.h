#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace runcert {

/// What people hand in: one receiver without corrections on a board, and what its device does.
struct PeopleKind {
    std::string name;
    double rate_hz = 1.0;
    double length_s = 600.0;
    bool velocities = false;
    bool speed_only = false;       ///< a speed without a course
    bool states_velocity = false;  ///< and how accurate it is
    bool cold_start = false;
    bool dropped = false;
    bool crash = false;
    bool filtered = false;  ///< positions smoothed by the device
};

std::vector<PeopleKind> people_kinds();

/// An error that the device does not tell.
enum class PeopleFault { none, step, spike, ramp, multipath };

/// One recording, certified for 3 s by position or judged against its own best.
struct PeopleRun {
    std::string kind;
    std::uint64_t seed = 0;
    PeopleFault fault = PeopleFault::none;
    std::string refused;     ///< why it is not certified; empty where it is
    double error_m_s = 0.0;  ///< measured speed less the true one of that window
    double expanded_m_s = 0.0;
    double usable = 0.0;                   ///< of all epochs
    double seconds_per_50000 = 0.0;        ///< processor time
    bool false_record = false;             ///< a record above the true speed counted as beaten
    std::map<std::string, double> budget;  ///< contributions by symbol, m/s
    double speed_m_s = 0.0;
    double start_s = 0.0;
};

struct PeopleOptions {
    std::int64_t runs = 200;  ///< of each kind
    std::uint64_t seed = 1;
    unsigned threads = 0;
    bool faults = false;  ///< each recording with one, and shorter
    std::string only;     ///< kinds whose name holds this
};

/// The run of a seed. With faults, a record is set 0.1 km/h above the fastest true speed over 3 s:
/// nothing honest beats it.
PeopleRun people_run(const PeopleKind& kind, std::uint64_t seed, bool fault);

std::vector<PeopleRun> study_people(const PeopleOptions& options);

/// By kind: certified, held by the interval, uncertainties, usable epochs, time; with faults by
/// kind of fault: how many were certified, missed, and counted as a record that was none.
std::string people_table(const std::vector<PeopleRun>& runs);
std::string people_csv(const std::vector<PeopleRun>& runs);

}  // namespace runcert
