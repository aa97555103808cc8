#include "core/speed_unit.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {

double metres_per_second(std::string_view unit) {
    if (unit == "m/s") return 1.0;
    if (unit == "km/h") return 1000.0 / 3600.0;
    if (unit == "kn") return 1852.0 / 3600.0;
    if (unit == "mph") return 1609.344 / 3600.0;
    throw Failure("unit", fmt::format("\"{}\" is not a unit of speed", escape_for_message(unit)),
                  "Use km/h, m/s, kn or mph");
}

}  // namespace runcert
