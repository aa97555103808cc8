#pragma once

#include "inertial/inertial_filter.h"

namespace runcert {

/// The solution that a smoothed pass gives, with its consistency. `turned`: what the pass still
/// turned the attitude by, over what it may.
InertialSolution solution_of(InertialPass&& pass, const InertialData& data,
                             const InertialSetup& setup, double turned);

}  // namespace runcert
