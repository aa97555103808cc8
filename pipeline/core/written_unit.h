#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace runcert {

// What the names and cells of any text say of units: one place for every format.

enum class Quantity { speed, length, angle, time };

/// A unit as recordings write it ("Km/h", "mph", "ft"), in metres a second, metres, degrees or
/// seconds.
struct Unit {
    std::string_view name;  ///< "km/h", "ft", as the attempt writes it
    Quantity quantity = Quantity::speed;
    double factor = 1.0;
};

/// The unit by any of its spellings, in any case: "km/h", "Kmph", "kilometers per hour". "ms" is
/// metres a second or milliseconds, by the quantity. Nothing for any other text.
std::optional<Unit> find_unit(std::string_view text, Quantity quantity);
/// Of whichever quantity.
std::optional<Unit> find_unit(std::string_view text);

/// The unit that a column's name says: in brackets ("Speed (km/h)", "GPS (2D speed) [m/s]"), as its
/// last words ("speed_kmh", "vel m/s", "SpeedKmh", "alt_ft"), or by being one ("KPH").
std::optional<Unit> unit_in_name(std::string_view name, Quantity quantity);

/// The same by brackets or by the whole name alone.
std::optional<Unit> unit_in_brackets(std::string_view name, Quantity quantity);

/// What the brackets at the end of a name hold, where that is written as a unit of speed ("dm/s")
/// and is none that is known; empty where there is no such thing.
std::string_view unknown_speed_unit(std::string_view name);

/// The name without brackets at its end: "Speed" of "Speed (km/h)".
std::string_view without_unit(std::string_view name);

/// Letters and digits of a name without its unit in brackets, in lower case: "gpslatitude" of
/// "GPS_Latitude (deg)".
std::string letters_of(std::string_view name);

/// Takes the unit off a cell: "75.2 km/h" becomes "75.2". Nothing where none stands there, and the
/// text stays.
std::optional<Unit> take_unit(std::string_view& cell, Quantity quantity);

/// The number of a cell, with a unit behind it or without.
std::optional<double> number_in(std::string_view cell);

/// Whether a cell says that there is no value: empty, "--", "N/A", "null", "NaN" and such.
bool is_missing(std::string_view cell);

/// The unit of speeds that a speed in metres a second, times `ratio`, would have: what fits within
/// a tenth.
std::optional<Unit> speed_unit_of_ratio(double ratio);

}  // namespace runcert
