#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/timed_value.h"
#include "schemas/screened/screened.h"
#include "witness/recorded_velocities.h"

// What was recorded twice is heard once: a witness that was made from another adds nothing to it.

namespace runcert {

/// Between speeds further apart than this (s) nothing is known.
inline constexpr double longest_between_speeds_s = 2.5;

/// How far a craft went.
struct Way {
    TimeSpan span;
    double length_m = 0.0;
};

/// What a witness may have been made from, as positions.
struct WitnessSource {
    std::string name;  ///< "the recorded velocities", "receiver "b""
    std::vector<TimedPosition<2>> positions = {};
    double delay_s = 0.0;                     ///< by what their times are late
    std::vector<TimedValue> speeds_m_s = {};  ///< that they are the sum of
};

/// Whether speeds (m/s), multiplied by the scale, are differences of these positions or filtered
/// ones (`are_filtered_positions`, `velocities::origin_of_speeds`). Their times are the positions'
/// own `delay_s` later. Integrated speeds are positions, too.
bool are_from_positions(std::span<const TimedValue> speeds,
                        std::span<const TimedPosition<2>> positions, double delay_s,
                        double scale = 1.0);

/// Whether the lengths of ways are those between the recorded positions there, taken linearly, more
/// exactly than the white noise of these would let them be but once in a hundred times.
bool are_between_positions(std::span<const Way> ways, std::span<const TimedPosition<2>> positions);

/// The recorded velocities, summed up, where screening found their errors.
std::optional<WitnessSource> source_by_velocities(const ScreenedTable& screened,
                                                  const Directions& directions);
/// Another receiver; nothing where the times of the two cannot be compared.
std::optional<WitnessSource> source_by_receiver(const ScreenedTable& screened,
                                                const ScreenedTable& other);

/// The name of the source that speeds, whose delay is `delay_s`, are differences of, or a filter of
/// these; nothing where they were measured on their own.
std::optional<std::string> source_of_speeds(std::span<const TimedValue> speeds_m_s,
                                            std::span<const WitnessSource> sources, double delay_s,
                                            double scale);

/// The same of ways, whose lengths are those between positions.
std::optional<std::string> source_of_ways(std::span<const Way> ways,
                                          std::span<const WitnessSource> sources);

/// "The wheel's speeds were made from the recorded velocities. ..."
std::string copy_text(std::string_view what, std::string_view source);

}  // namespace runcert
