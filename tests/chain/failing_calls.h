#pragma once

#include <array>
#include <atomic>

namespace runcert::chain {

/// The file by which a test and the programs it starts share this state.
inline constexpr const char* fault_variable = "RUNCERT_TEST_FAULTS";

/// Which calls fail, and how many there were of each kind.
struct FaultState {
    /// w: write to a file; h: of a write only the first half is done; s: fsync; r: rename, link;
    /// m: make a folder; u: remove; a: allocate.
    std::atomic<char> kind{};
    std::atomic<bool> from_then_on{};
    std::atomic<long> at{};                      ///< number of the call, from 1; 0: none fails
    std::array<std::atomic<long>, 128> calls{};  ///< by the letter of their kind
};

}  // namespace runcert::chain
