#pragma once

#include "schemas/enu/declared.h"

namespace runcert {}  // namespace runcert
