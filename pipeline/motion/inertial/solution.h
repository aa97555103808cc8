#pragma once

#include "inertial/inertial_filter.h"

namespace runcert {

/// The solution that a smoothed pass gives, with its consistency.
template <int N>
InertialSolution solution_of(InertialPass<N>&& pass, const InertialData& data,
                             const InertialSetup& setup, bool converged);

}  // namespace runcert
