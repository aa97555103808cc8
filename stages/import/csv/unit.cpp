#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/csv/layout.h"

namespace runcert::csv {
namespace {

/// A unit, and how headers write it, in lower case. The factors are exact by the units' definitions
/// (BIPM, SI Brochure; 1959 yard).
struct Spelled {
    Unit unit;
    std::array<std::string_view, 4> spellings;
};
constexpr Spelled units[] = {
    {{"m/s", Quantity::speed, 1.0}, {"m/s", "mps"}},
    {{"km/h", Quantity::speed, 1.0 / 3.6}, {"km/h", "kmh", "kph", "kmph"}},
    {{"mph", Quantity::speed, 0.44704}, {"mph", "mi/h"}},
    {{"kn", Quantity::speed, 1852.0 / 3600.0}, {"kn", "kt", "kts", "knots"}},
    {{"ft/s", Quantity::speed, 0.3048}, {"ft/s"}},
    {{"m", Quantity::length, 1.0}, {"m", "meter", "meters", "metres"}},
    {{"cm", Quantity::length, 0.01}, {"cm"}},
    {{"mm", Quantity::length, 0.001}, {"mm"}},
    {{"ft", Quantity::length, 0.3048}, {"ft", "feet"}},
    {{"deg", Quantity::angle, 1.0}, {"deg", "degrees"}},
    {{"rad", Quantity::angle, Angle::from_radians(1.0).degrees()}, {"rad", "radians"}},
    {{"s", Quantity::time, 1.0}, {"s", "sec", "seconds"}},
    {{"ms", Quantity::time, 0.001}, {"ms", "0.001 s", "milliseconds"}}};
/// Of speeds that programs write: of those above, the first.
constexpr std::size_t usual_speeds = 4;

/// Where the brackets at the end of a name begin; its size where there are none.
std::size_t brackets_of(std::string_view name) {
    if (!name.ends_with(')') && !name.ends_with(']')) return name.size();
    const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
    return open == std::string_view::npos ? name.size() : open;
}

std::string_view word_of(Quantity quantity) {
    constexpr std::string_view words[] = {"m/s", "metres", "degrees", "seconds"};
    return words[static_cast<std::size_t>(quantity)];
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text) {
    const std::string lower = lower_case(trim(text));
    if (lower.empty()) return std::nullopt;
    for (const Spelled& each : units)
        if (std::ranges::find(each.spellings, lower) != each.spellings.end()) return each.unit;
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
    for (const Spelled& each : std::span(units).first(usual_speeds))
        if (std::abs(ratio * each.unit.factor - 1.0) < 0.07) return each.unit;
    return std::nullopt;
}

std::optional<Unit> unit_of_column(const Head& head, std::size_t column) {
    if (auto unit = unit_in_name(head.names[column].text)) return unit;
    for (const std::vector<Cell>& line : head.under)
        if (column < line.size())
            if (auto unit = find_unit(line[column].text)) return unit;
    return std::nullopt;
}

void set_units(Layout& layout, const Description& description, const Receiver& receiver) {
    for (std::size_t i = 0; i < layout.place.size(); ++i) {
        const auto column = static_cast<Column>(i);
        const auto quantity = column_kinds[i].quantity;
        if (!layout.place[i] || !quantity) continue;
        // Dates and times of day have no unit, whatever a name says; that of counts is settled
        // later.
        if (column == Column::time && description.time_format != TimeFormat::seconds_of_week &&
            description.time_format != TimeFormat::seconds)
            continue;
        const Cell& name = layout.head.names[*layout.place[i]];
        std::optional<Unit> unit = unit_of_column(layout.head, *layout.place[i]);
        if (unit && unit->quantity != *quantity) unit.reset();
        if (unit && unit->name == "ms" && description.time_format == TimeFormat::seconds) continue;
        if (unit && column_kinds[i].keeps_unit && unit->factor != 1.0)
            name.fail(
                fmt::format("the {} \"{}\" is in {}",
                            column == Column::time ? "time" : "coordinate",
                            escape_for_message(name.text), unit->name),
                fmt::format("Give the recording with {} in {}",
                            column == Column::time ? "times" : "coordinates", word_of(*quantity)));
        if (*quantity == Quantity::speed && description.speed_unit) {
            if (unit && unit->name != description.speed_unit->name)
                name.fail(fmt::format("the header says {}, and the attempt's speed_unit {}",
                                      unit->name, receiver.speed_unit),
                          "Remove speed_unit from the receiver, or write that unit");
            unit = description.speed_unit;
        }
        if (!unit) continue;
        layout.factor[i] = unit->factor;
        if (unit->factor != 1.0)
            layout.notes.push_back(fmt::format("The column \"{}\" is in {}, and was turned to {}.",
                                               escape_for_message(name.text), unit->name,
                                               word_of(*quantity)));
    }
}

}  // namespace runcert::csv
