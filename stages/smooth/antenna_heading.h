#pragma once

#include <string>

#include "inertial/inertial_smoother.h"
#include "schemas/attitude/declared.h"

namespace runcert {

/// Compares the heading by two antennas with the inertial one (`judge_baseline`), and sets it in
/// the rows of the table. `receiver` is the id of the second. Does nothing where the setup has no
/// baseline.
void compare_headings(const InertialSolution& solution, const InertialSetup& setup,
                      const std::string& receiver, AttitudeTable& table);

}  // namespace runcert
