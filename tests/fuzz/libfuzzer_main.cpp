#include <cstddef>
#include <cstdint>

#include "fuzz_target.h"

/// libFuzzer's entry (LLVM documentation, "libFuzzer: a library for coverage-guided fuzz testing").
/// What run_target throws ends the program, and so is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    runcert::fuzz::run_target({reinterpret_cast<const char*>(data), size});
    return 0;
}
