#pragma once

#include <cstdint>
#include <string_view>

namespace runcert {

/// About how many epochs a recording of any format holds, told from its bytes without reading it:
/// what marks an epoch in NMEA, UBX, GPX and RINEX is counted, in other texts lines, and other
/// binary recordings take 32 bytes or more for one. Rather too many than too few.
std::uint64_t estimated_epochs(std::string_view recording);

}  // namespace runcert
