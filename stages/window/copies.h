#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "estimation/tables/handed_in.h"
#include "estimation/tables/recorded_velocities.h"
#include "schemas/screened/screened.h"

// What was recorded twice is heard once: a witness that was made from another adds nothing to it.

namespace runcert {

/// What a witness may have been made from, as positions.
struct WitnessSource {
    std::string name;  ///< "the recorded velocities", "receiver "b""
    std::vector<TimedPosition<2>> positions = {};
    double delay_s = 0.0;                     ///< by what their times are late
    std::vector<TimedValue> speeds_m_s = {};  ///< that they are the sum of
};

/// The recorded velocities, summed up, where screening found their errors.
std::optional<WitnessSource> source_by_velocities(const ScreenedTable& screened,
                                                  const Directions& directions);
/// Another receiver; nothing where the times of the two cannot be compared.
std::optional<WitnessSource> source_by_receiver(const ScreenedTable& screened,
                                                const ScreenedTable& other);

/// The name of the source that speeds, whose delay is `delay_s`, are differences of, or a filter of
/// these; nothing where they were measured on their own.
std::optional<std::string> source_of_speeds(const std::vector<TimedValue>& speeds_m_s,
                                            const std::vector<WitnessSource>& sources,
                                            double delay_s, double scale);

/// The same of passages of gates, the ways between which are those between positions.
std::optional<std::string> source_of_gates(const std::vector<TimedValue>& passages_m,
                                           const std::vector<WitnessSource>& sources);

/// "The wheel's speeds were made from the recorded velocities. ..."
std::string copy_text(std::string_view what, std::string_view source);

}  // namespace runcert
