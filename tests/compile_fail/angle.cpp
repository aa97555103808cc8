#include "core/angle.h"

#include "core/geodesy.h"

#if defined(ANGLE_FROM_DOUBLE)
const runcert::Angle angle = 3.0;
#else
const runcert::Angle angle = runcert::Angle::from_degrees(3.0);
#endif

#if defined(POSITION_FROM_DOUBLES)
const runcert::Geodetic position{35.0, 137.0, 100.0};
#else
const runcert::Geodetic position{angle, angle, 100.0};
#endif
