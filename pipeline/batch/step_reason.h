#pragma once

#include <chrono>
#include <string>

#include "batch/run_record.h"
#include "files/process.h"

namespace runcert {

/// A step's program says a few lines; beyond so many bytes it says nonsense without end, and is
/// ended before it fills the memory.
inline constexpr std::size_t most_output_of_step = std::size_t{16} << 20;

/// What a step would now be made from that it was not made from before, in words ("parameters:
/// seed 1 -> 2"); empty where all is as it was. What was written is not looked at.
std::string what_changed(const StepRecord& before, const StepRecord& now);

/// The failure of a step whose program did not end well: its own three lines where it said them,
/// else how it ended.
RunFailure failure_of_program(const std::string& step, const ProcessResult& result,
                              std::chrono::milliseconds time_limit);

}  // namespace runcert
