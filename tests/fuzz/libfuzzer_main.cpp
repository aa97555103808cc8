#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "fuzz_target.h"

const std::string& runcert::fuzz::target_name() {
    static const std::string name = [] {
        const std::string program = program_invocation_short_name;
        return program.substr(0, program.rfind("_fuzz"));
    }();
    return name;
}

/// libFuzzer's entry (LLVM documentation, "libFuzzer: a library for coverage-guided fuzz testing").
/// What run_target throws ends the program, and so is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    runcert::fuzz::run_target({reinterpret_cast<const char*>(data), size});
    return 0;
}
