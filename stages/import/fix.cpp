#include "stages/import/fix.h"

#include <fmt/format.h>

#include <array>

#include "core/text.h"

namespace runcert {

FixKind read_rtklib_quality(const Cell& cell) {
    static constexpr std::array<FixKind, 8> kinds{
        FixKind::none,   FixKind::fixed, FixKind::float_ambiguities, FixKind::sbas, FixKind::dgps,
        FixKind::single, FixKind::ppp,   FixKind::dead_reckoning};
    const std::optional<double> value = parse_double(cell.text);
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (value == static_cast<double>(i)) return kinds[i];
    cell.fail(fmt::format("Q \"{}\" is not a kind of solution", escape_for_message(cell.text)),
              "RTKLIB writes 1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP, 7 dead reckoning, "
              "0 none");
}

std::int16_t read_satellites(const Cell& cell) {
    return static_cast<std::int16_t>(read_whole(cell, "count of satellites", 0, 1000));
}

}  // namespace runcert
