#include "estimation/motion_smoother_definitions.h"

namespace runcert {

template class MotionSmoother<1, 4>;
template class MotionSmoother<2, 4>;

}  // namespace runcert
