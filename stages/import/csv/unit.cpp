#include "stages/import/csv/unit.h"

#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"

namespace runcert::csv {
namespace {

constexpr Unit metre_a_second{"m/s", Quantity::speed, 1.0};
constexpr Unit kilometre_an_hour{"km/h", Quantity::speed, 1.0 / 3.6};
constexpr Unit mile_an_hour{"mph", Quantity::speed, 0.44704};
constexpr Unit knot{"kn", Quantity::speed, 1852.0 / 3600.0};
constexpr Unit foot_a_second{"ft/s", Quantity::speed, 0.3048};
constexpr Unit metre{"m", Quantity::length, 1.0};
constexpr Unit centimetre{"cm", Quantity::length, 0.01};
constexpr Unit millimetre{"mm", Quantity::length, 0.001};
constexpr Unit foot{"ft", Quantity::length, 0.3048};
constexpr Unit degree{"deg", Quantity::angle, 1.0};
constexpr Unit radian{"rad", Quantity::angle, Angle::from_radians(1.0).degrees()};
constexpr Unit second{"s", Quantity::time, 1.0};
constexpr Unit millisecond{"ms", Quantity::time, 0.001};

struct Spelling {
    std::string_view text;
    Unit unit;
};

/// In lower case. The factors are exact by the units' definitions (BIPM, SI Brochure; 1959 yard).
constexpr std::array spellings{Spelling{"m/s", metre_a_second},
                               Spelling{"mps", metre_a_second},
                               Spelling{"km/h", kilometre_an_hour},
                               Spelling{"kmh", kilometre_an_hour},
                               Spelling{"kph", kilometre_an_hour},
                               Spelling{"kmph", kilometre_an_hour},
                               Spelling{"mph", mile_an_hour},
                               Spelling{"mi/h", mile_an_hour},
                               Spelling{"kn", knot},
                               Spelling{"kt", knot},
                               Spelling{"kts", knot},
                               Spelling{"knots", knot},
                               Spelling{"ft/s", foot_a_second},
                               Spelling{"m", metre},
                               Spelling{"meter", metre},
                               Spelling{"meters", metre},
                               Spelling{"metres", metre},
                               Spelling{"cm", centimetre},
                               Spelling{"mm", millimetre},
                               Spelling{"ft", foot},
                               Spelling{"feet", foot},
                               Spelling{"deg", degree},
                               Spelling{"degrees", degree},
                               Spelling{"rad", radian},
                               Spelling{"radians", radian},
                               Spelling{"s", second},
                               Spelling{"sec", second},
                               Spelling{"seconds", second},
                               Spelling{"ms", millisecond},
                               Spelling{"0.001 s", millisecond},
                               Spelling{"milliseconds", millisecond}};

/// Where the brackets at the end of a name begin; its size where there are none.
std::size_t brackets_of(std::string_view name) {
    if (!name.ends_with(')') && !name.ends_with(']')) return name.size();
    const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
    return open == std::string_view::npos ? name.size() : open;
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text) {
    const std::string lower = lower_case(trim(text));
    for (const Spelling& spelling : spellings)
        if (spelling.text == lower) return spelling.unit;
    return std::nullopt;
}

std::optional<Unit> unit_in_name(std::string_view name) {
    name = trim(name);
    const std::size_t open = brackets_of(name);
    if (open < name.size()) return find_unit(name.substr(open + 1, name.size() - open - 2));
    const std::optional<Unit> itself = find_unit(name);
    // "M" is rather a name.
    return itself && itself->quantity == Quantity::speed ? itself : std::nullopt;
}

std::string_view without_unit(std::string_view name) {
    name = trim(name);
    return trim(name.substr(0, brackets_of(name)));
}

std::optional<Unit> speed_unit_of_ratio(double ratio) {
    for (const Unit& unit : {metre_a_second, kilometre_an_hour, mile_an_hour, knot})
        if (std::abs(ratio * unit.factor - 1.0) < 0.07) return unit;
    return std::nullopt;
}

}  // namespace runcert::csv
