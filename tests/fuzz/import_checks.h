#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"

namespace runcert::fuzz {

/// Imports a recording and checks what must hold of every result: rows numbered from 1, geodetic
/// coordinates, figures finite, bad records fewer than good ones. Of some results, chosen by the
/// recording's length, also that they can be inspected, or written and read again.
void import_and_check(const Receiver& receiver, std::string_view bytes);

}  // namespace runcert::fuzz
