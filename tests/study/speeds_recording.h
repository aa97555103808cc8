#pragma once

#include <string>
#include <vector>

#include "people_motion.h"
#include "schemas/enu/declared.h"

namespace runcert {

/// How the positions beside recorded speeds come about, or the speeds beside the positions.
enum class SpeedsPositions {
    independent,  ///< code positions that wander by half a metre (30 s)
    integrated,   ///< from the recorded velocities, and 5 mm of noise
    smoothed,     ///< code positions over a time constant, the integrated velocities within it
    differenced   ///< code positions of 1 cm of noise, whose differences are the velocities
};

/// Samples in a row, among the fastest tenth of a session, whose speed is too high by a part of it.
struct SpeedsSpike {
    double part = 0.0;
    int samples = 1;
    double stated_m_s = 0.0;  ///< what the receiver states there; 0: as elsewhere
};

/// Sessions by one device. Noise and time-correlated errors are of each axis.
struct SpeedsCell {
    std::string name = {};
    double rate_hz = 10.0;
    double length_s = 300.0;
    double white_m_s = 0.1;
    double white_filter_s = 0.0;  ///< time constant of a filter of that noise, which keeps its size
    double slow_m_s = 0.05;
    double slow_tau_s = 20.0;
    double stated_m_s = 0.3;
    double scale = 1.0;
    double low_pass_s = 0.0;  ///< time constant of a first-order filter of the motion; 0: none
    bool overshoots = false;  ///< a filter of the motion with a period of 2 s, damped by 0.4
    bool bursts = false;      ///< each 30 s one of 0.3 to 3 m/s along the track, for 1 to 3 s
    bool jitters = false;     ///< stamps by up to 20 ms; 1 to 5 % of the samples are lost
    bool equal_legs = false;  ///< 24 straight legs of one profile of the speed
    SpeedsSpike spike = {};
    SpeedsPositions positions = SpeedsPositions::independent;
    double positions_tau_s = 0.0;  ///< of smoothed ones
    double wave_m = 0.0;           ///< by which positions go to and fro in 20 s, beside all else
    double added_m = 0.0;          ///< white noise on positions, beside all else
    double added_m_s = 0.0;        ///< white noise on velocities that are differences

    /// By what a filter delays a steady change of the speed.
    double delay_s() const;
};

/// What a device recorded, and the truth.
struct SpeedsRecording {
    TruePath path;
    EnuTable measured;
};
SpeedsRecording record_speeds(const SpeedsCell& cell, std::uint64_t seed);

}  // namespace runcert
