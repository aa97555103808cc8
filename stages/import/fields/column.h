#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/written_unit.h"
#include "schemas/observations/observations.h"

namespace runcert::csv {

/// What a column may hold: the keys of `columns` in an attempt, but for the last five.
enum class Column : std::size_t {
    time,
    week,
    date,
    east,
    north,
    up,
    latitude,
    longitude,
    height,
    x,
    y,
    z,
    sigma_east,
    sigma_north,
    sigma_up,
    quality_2d,
    quality_height,
    velocity_east,
    velocity_north,
    velocity_up,
    speed,
    course,
    sigma_speed,
    fix,
    satellites,
    new_fix,
    // Found beside the others by what they hold, and no keys of an attempt.
    north_south,
    east_west,
    milliseconds,
    provider,
    mock,
    count
};

/// What a column holds.
struct ColumnKind {
    std::string_view name;                            ///< its key in an attempt ("sigma_east")
    std::optional<Quantity> quantity = std::nullopt;  ///< of its numbers, where they have a unit
    bool keeps_unit = false;  ///< coordinates and times keep the decimals they are written with
};

/// In the order of Column.
inline constexpr std::array<ColumnKind, static_cast<std::size_t>(Column::count)> column_kinds{
    {{"time", Quantity::time, true},
     {"week"},
     {"date"},
     {"east", Quantity::length, true},
     {"north", Quantity::length, true},
     {"up", Quantity::length},
     {"latitude", Quantity::angle, true},
     {"longitude", Quantity::angle, true},
     {"height", Quantity::length},
     {"x", Quantity::length, true},
     {"y", Quantity::length, true},
     {"z", Quantity::length, true},
     {"sigma_east", Quantity::length},
     {"sigma_north", Quantity::length},
     {"sigma_up", Quantity::length},
     {"quality_2d", Quantity::length},
     {"quality_height", Quantity::length},
     {"velocity_east", Quantity::speed},
     {"velocity_north", Quantity::speed},
     {"velocity_up", Quantity::speed},
     {"speed", Quantity::speed},
     {"course", Quantity::angle},
     {"sigma_speed", Quantity::speed},
     {"fix"},
     {"satellites"},
     {"new_fix"},
     {"north_south"},
     {"east_west"},
     {"milliseconds"},
     {"provider"},
     {"mock"}}};

constexpr std::string_view name_of(Column column) {
    return column_kinds[static_cast<std::size_t>(column)].name;
}

/// How programs call the columns of a meaning: letters and digits of the name, in lower case. Of
/// several the first that is there counts.
struct KnownNames {
    Column column;
    std::string_view names;  ///< parted by blanks
};

/// The words of a text that blanks part.
std::vector<std::string_view> words_of(std::string_view text);

/// Of geodetic, Earth-centred and plane coordinates, and of all else.
std::span<const KnownNames> geodetic_names();
std::span<const KnownNames> ecef_names();
std::span<const KnownNames> plane_names();
std::span<const KnownNames> other_names();

/// The names of columns that hold both coordinates.
std::vector<std::string_view> names_of_both();

/// Whether a name, whole, is one of a meaning.
bool is_named(std::string_view name, Column column);

/// Whether a name says that its numbers count downwards, of heights or velocities: "Velocity down".
bool counts_down(std::string_view name);

/// The fix type of a word or number: "RTK Integer", "fixed", "SPS"; RTKLIB's number Q.
std::optional<FixType> fix_by_word(std::string_view word);

}  // namespace runcert::csv
