#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// What a Locosys logger says of itself in its file identification (SiRF message 253): name, serial
/// number, logging rate, firmware, as printable text ("GT-31, 30003117, 1, V1.4"). Empty where
/// there is none.
std::string locosys_device(std::string_view file_id);

}  // namespace runcert
