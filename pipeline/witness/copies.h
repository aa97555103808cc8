#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/timed_value.h"
#include "schemas/screened/screened.h"
#include "witness/recorded_velocities.h"

// Detects witnesses that were made from the positions or from another witness. A copy adds no
// evidence.

namespace runcert {

/// The motion is taken as unknown between speeds further apart than this (s).
inline constexpr double longest_between_speeds_s = 2.5;

/// The length of a craft's path over a time span.
struct Way {
    TimeSpan span;
    double length_m = 0.0;
};

/// Data that a witness may have been made from, in the form of positions.
struct WitnessSource {
    std::string name;  ///< "the recorded velocities", "receiver "b""
    std::vector<TimedPosition<2>> positions = {};
    double delay_s = 0.0;                     ///< by how much their times are late
    std::vector<TimedValue> speeds_m_s = {};  ///< speeds that the positions are the integral of, if
                                              ///< any
};

/// Whether speeds (m/s), multiplied by `scale`, are differences of these positions or a filter of
/// them (`are_filtered_positions`, `velocities::origin_of_speeds`). Times of the speeds are those
/// of the positions plus `delay_s`. Positions may also be integrated speeds.
bool are_from_positions(std::span<const TimedValue> speeds,
                        std::span<const TimedPosition<2>> positions, double delay_s,
                        double scale = 1.0);

/// Whether path lengths match those between recorded positions, interpolated linearly, too closely.
/// That is so where the positions' white noise would allow it only once in a hundred times.
bool are_between_positions(std::span<const Way> ways, std::span<const TimedPosition<2>> positions);

/// The integral of the recorded velocities. Empty if screening did not determine their errors.
std::optional<WitnessSource> source_by_velocities(const ScreenedTable& screened,
                                                  const Directions& directions);
/// The positions of another receiver. Empty if the times of the two cannot be compared.
std::optional<WitnessSource> source_by_receiver(const ScreenedTable& screened,
                                                const ScreenedTable& other);

/// The name of the source that speeds delayed by `delay_s` are a difference or filter of. Empty
/// if they were measured independently.
std::optional<std::string> source_of_speeds(std::span<const TimedValue> speeds_m_s,
                                            std::span<const WitnessSource> sources, double delay_s,
                                            double scale);

/// The name of the source between whose positions the lengths of these ways were taken. Empty if
/// they were measured independently.
std::optional<std::string> source_of_ways(std::span<const Way> ways,
                                          std::span<const WitnessSource> sources);

/// "The wheel's speeds were made from the recorded velocities. ..."
std::string copy_text(std::string_view what, std::string_view source);

}  // namespace runcert
