#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "core/gps_time.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// How often each positive step of time (ns) between rows that follow each other occurs: there are
/// few different ones, and a copy of all would cost much memory.
class StepCount {
  public:
    void add(std::int64_t step_ns);
    /// Their median (s); 0 where there is none.
    double median_s() const;

  private:
    std::map<std::int64_t, std::size_t> count_;
    std::size_t steps_ = 0;
};

/// What the rows of a recording show as a whole, gathered one by one, so that nobody needs to hold
/// them for it.
class RowSummary {
  public:
    /// Takes in a row, whose time still counts from the GPS epoch.
    void add(const Observation& row);

    std::int64_t rows = 0;
    GpsTime first;  ///< instant of the first row
    GpsTime last;   ///< the latest instant
    StepCount steps;
    /// The first row more than 292 years from the first or from the one before it, whose difference
    /// does not fit into the nanoseconds of 64 bits: its line, 1 where it has none.
    std::optional<std::int64_t> line_of_another_age;
    std::optional<double> first_latitude_deg;
    bool any_height = false;
    bool any_horizontal = false;          ///< accuracy
    bool any_vertical = false;            ///< accuracy
    std::int64_t without_horizontal = 0;  ///< rows that have a position, and no accuracy of it
    std::int64_t with_velocity = 0;       ///< rows with a recorded velocity or speed
    std::int64_t speeds_alone = 0;        ///< those of them that have no course
    std::int64_t velocity_unstated = 0;   ///< those of them that state no accuracy of it

  private:
    void add_time(const Observation& row);

    GpsTime before_;
};

bool has_horizontal_accuracy(const Observation& row);
bool has_position(const Observation& row);
/// Whether the horizontal components of the recorded velocity are there.
bool has_velocity(const RecordedVelocity& row);
/// Whether the accuracy of the recorded velocity, or speed, is stated.
bool has_velocity_accuracy(const RecordedVelocity& row);

}  // namespace runcert
