#pragma once

#include <filesystem>

#include "run/verification.h"

namespace runcert {

/// Runs all stages again, from the run folder's own copies of attempt, profiles and recordings,
/// and compares every file with the one in the folder: identical, or, where the program or the
/// processor is another, every number within a thousandth of its stated uncertainty (where it has
/// none: one unit of its last written digit). The first deviation is named with file, line and
/// column.
VerificationStep verify_recomputation(const std::filesystem::path& run_dir);

}  // namespace runcert
