#pragma once

#include <string>

#include "schemas/observations/observations.h"

namespace runcert {

/// "solved by RTKLIB ver.2.4.3 from rover.obs, base.obs, as the recording's header says", without
/// what it does not say.
std::string processing_text(const Processing& processing);

}  // namespace runcert
