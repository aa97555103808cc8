#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/angle.h"

namespace runcert {

/// What a coordinate is written in, the unit of its decimals.
enum class CoordinateUnit { metre, degree, arc_minute, arc_second };

/// Those pieces of a row's text whose decimals say how finely it states its time and place. They
/// belong to the recording.
struct WrittenCells {
    std::string_view time;  ///< a count of seconds, a time of day, or date and time of day
    CoordinateUnit unit = CoordinateUnit::metre;
    /// Latitude and longitude (their seconds, where `unit` is that); or the horizontal
    /// coordinates; or all of the Earth-centred ones. Empty where the row has no position.
    std::array<std::string_view, 3> coordinates;
};

/// The decimals of a column: the most of any row, because some writers leave trailing zeros out.
class WrittenDecimals {
  public:
    /// Takes in a cell that was read as a number or a time.
    void see(std::string_view text);

    /// Whether there was a cell at all.
    bool any() const { return any_; }

    /// The step of the last decimal, in units of the column; nothing where there was no cell, or
    /// one whose decimals are not plain to see: a number with an exponent.
    std::optional<double> step() const;

  private:
    bool any_ = false;
    bool unclear_ = false;
    int most_ = 0;
};

/// The smallest steps that a recording can show, by how its rows are written. Steps below a
/// nanometre or a nanosecond count as one: such decimals come from arithmetic, not from a receiver.
class WrittenResolution {
  public:
    WrittenResolution() = default;
    /// Of a binary format, whose steps are known: in units of the coordinates, and in seconds.
    WrittenResolution(CoordinateUnit unit, double coordinate_step, double time_step_s);

    /// Takes in a row. All rows that have a position have it in the same unit.
    void see(const WrittenCells& cells);

    /// The step of its times, s.
    std::optional<double> time_s() const;

    /// The step of its coarsest horizontal coordinate, m. A degree counts its length
    /// along the meridian or the parallel of the WGS 84 ellipsoid at `latitude`; a metre of a UTM
    /// grid counts as one on the ground.
    std::optional<double> position_m(Angle latitude) const;

  private:
    double metres_per_unit(std::size_t coordinate, Angle latitude) const;

    std::optional<double> known_coordinate_step_, known_time_step_s_;
    CoordinateUnit unit_ = CoordinateUnit::metre;
    WrittenDecimals time_;
    std::array<WrittenDecimals, 3> coordinates_;
};

}  // namespace runcert
