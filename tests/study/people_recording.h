#pragma once

#include <optional>
#include <string>
#include <vector>

#include "people_motion.h"
#include "schemas/enu/declared.h"

namespace runcert {

/// What a device records of velocity.
enum class PeopleVelocities { none, stated, unstated, speed_alone };
/// What a kind's name says of it: ", velocities", empty for none.
std::string_view velocities_words(PeopleVelocities velocities);

/// One kind of recording that people hand in: a single receiver on a board.
struct PeopleKind {
    std::string name = {};
    double rate_hz = 1.0;  ///< 1, 5 or 10
    double shortest_s = 300.0;
    double longest_s = 1800.0;
    PeopleVelocities velocities = PeopleVelocities::none;
    bool cold_start = false;  ///< no fix, then stated standard deviations that fall from 1000 m
    bool drops = false;       ///< 1 to 5 % of the samples are not there, up to 3 s in a row
    bool crash = false;       ///< a sudden stop at the end, with a jump by multipath
    bool filtered = false;    ///< the device smooths its positions
};

/// Plain ones at 1, 5 and 10 Hz, and each trouble, without velocities and with them.
std::vector<PeopleKind> people_kinds();

/// What is put on the positions of a recording beside the errors of its device.
enum class PeopleFault { none, step, spike, ramp, multipath };
std::string to_text(PeopleFault fault);

/// The errors of one device, standard deviations of each axis.
struct PeopleDevice {
    double white_m = 0.0;
    double slow_m = 0.0;  ///< of a steady Gauss-Markov error
    double slow_tau_s = 1.0;
    double stated_m = 0.0;
    double filter_s = 0.0;  ///< time constant of its smoothing; 0 where it does none
    double velocity_white_m_s = 0.0;
    double velocity_slow_m_s = 0.0;
    double velocity_tau_s = 1.0;
    double velocity_stated_m_s = 0.0;
    double velocity_late_s = 0.0;  ///< by which velocities are older than positions
};

struct PeopleRecording {
    PeopleDevice device;
    TruePath path;
    EnuTable measured;
    std::string fault;  ///< in words; empty where there is none
};

/// Time-correlated errors of 0.5 to 2 m (5 to 60 s), white noise of 0.05 to 0.3 m; stated standard
/// deviations of 1 to 3 m in the plane, one in four wrong by a factor of 2; velocities late by 0 to
/// 0.5 s, with white noise of 0.03 to 0.1 m/s and time-correlated errors of 0.02 to 0.1 m/s (5 to
/// 30 s). One to three faults of one kind: steps of 2 to 30 m, spikes of 3 to 100 m, ramps of 0.05
/// to 2 m/s for 3 to 30 s, and multipath that rises to 1 to 30 m and falls within 1 to 30 s; half
/// of them along the motion.
PeopleRecording record_people(const PeopleKind& kind, PeopleFault fault, std::uint64_t seed);

}  // namespace runcert
