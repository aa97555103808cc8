#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "stages/import/novatel/log.h"
#include "stages/import/row_collector.h"

namespace runcert::novatel {

/// The logs whose positions are read, the one that is preferred first: those of the satellites
/// before those that an inertial unit takes part in.
std::span<const std::string_view> position_logs();

bool is_inertial(std::string_view log);

/// The log of velocities that goes with one of positions; empty where that has its own.
std::string_view velocity_log(std::string_view position_log);

/// A log of positions as a row. A log without a solution is a row without position. Failure for a
/// position type or a datum that is not known.
TimedRow read_position(const Log& log);

/// Puts the velocity of a log of velocities into a row of the same time. Returns its latency (s),
/// by which the receiver says that it is older than its time.
double read_velocity(const Log& log, Observation& row);

GpsTime instant_of(const Log& log);

}  // namespace runcert::novatel
