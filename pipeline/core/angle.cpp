#include "core/angle.h"

namespace runcert {

static_assert(Angle::from_radians(std::numbers::pi / 2).degrees() == 90.0);
static_assert(Angle::from_degrees(180.0).radians() == std::numbers::pi);
static_assert(Angle::from_dms(-1, 0.0, 30.0, 0.0) == Angle::from_degrees(-0.5));

}  // namespace runcert
