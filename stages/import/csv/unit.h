#pragma once

#include <optional>
#include <string_view>

namespace runcert::csv {

enum class Quantity { speed, length, angle, time };

/// A unit as the headers of tables write it ("Km/h", "mph", "ft"), in metres a second, metres,
/// degrees or seconds.
struct Unit {
    std::string_view name;  ///< "km/h", "ft", as the attempt writes it
    Quantity quantity = Quantity::speed;
    double factor = 1.0;
};

/// By any of its spellings, in any case; nothing for a text that is none.
std::optional<Unit> find_unit(std::string_view text);

/// What a header's name says of its unit: "Speed (km/h)", "Altitude [m]", or a name that is a unit
/// itself ("KPH").
std::optional<Unit> unit_in_name(std::string_view name);

/// The name without a unit in brackets at its end: "Speed" of "Speed (km/h)".
std::string_view without_unit(std::string_view name);

/// The unit of speeds that a speed in metres a second, times `ratio`, would have: what fits within
/// a tenth.
std::optional<Unit> speed_unit_of_ratio(double ratio);

}  // namespace runcert::csv
