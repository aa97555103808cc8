#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/gps_time.h"

namespace runcert {

/// The rules that come with the program and are for craft of that class, as an attempt names them;
/// none where no body's rule is. `when`: of the recording; a rule that holds from a later day is
/// left out for the one that it replaces.
std::vector<std::string> fitting_rules(const std::string& craft_class,
                                       const std::optional<GpsTime>& when);

}  // namespace runcert
