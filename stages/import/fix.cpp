#include "stages/import/fix.h"

#include <fmt/format.h>

#include <array>

#include "core/text.h"

namespace runcert {

FixType read_rtklib_quality(const Cell& cell) {
    static constexpr std::array<FixType, 8> kinds{
        FixType::none,   FixType::fixed, FixType::float_ambiguities, FixType::sbas, FixType::dgps,
        FixType::single, FixType::ppp,   FixType::dead_reckoning};
    const std::optional<double> value = parse_double(cell.text);
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (value == static_cast<double>(i)) return kinds[i];
    cell.fail(fmt::format("Q \"{}\" is not a fix type", escape_for_message(cell.text)),
              "RTKLIB writes 1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP, 7 dead reckoning, "
              "0 none");
}

std::int16_t read_satellites(const Cell& cell) {
    return static_cast<std::int16_t>(read_whole(cell, "count of satellites", 0, 1000));
}

}  // namespace runcert
