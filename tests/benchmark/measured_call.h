#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace runcert {

/// What one call of `runcert batch --json` took and did.
struct MeasuredCall {
    double wall_s = 0.0;
    double processor_s = 0.0;  ///< of the call and all programs that it ran
    /// The largest resident memory of runcert itself (VmHWM), looked at every 10 ms.
    std::uint64_t own_peak_bytes = 0;
    /// The same of the largest process: of runcert and all programs that it ran.
    std::uint64_t largest_peak_bytes = 0;
    double first_stage_s = 0.0;  ///< from the start of the call to that of the first stage
    std::map<std::string, std::size_t> ran = {};  ///< steps that were done, and how often
    std::size_t kept = 0;                         ///< steps that needed not
    std::size_t done = 0;                         ///< attempts that are done
};

/// Runs such a call to its end; where `stop_after` is not 0, asks it (SIGINT) to finish when so
/// many attempts have ended. Failure where it ends otherwise than it should.
MeasuredCall measured_call(std::vector<std::string> command, std::size_t stop_after = 0);

}  // namespace runcert
