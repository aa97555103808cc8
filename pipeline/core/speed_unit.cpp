#include "core/speed_unit.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {

double metres_per_second(std::string_view unit) {
    if (unit == "m/s") return 1.0;
    if (unit == "km/h") return km_h_in_m_s;
    if (unit == "kn") return knot_in_m_s;
    if (unit == "mph") return mph_in_m_s;
    throw Failure("unit", fmt::format("\"{}\" is not a unit of speed", escape_for_message(unit)),
                  "Use km/h, m/s, kn or mph");
}

}  // namespace runcert
