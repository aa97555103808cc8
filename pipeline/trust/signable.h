#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trust/verification.h"

namespace runcert {

/// Failure, with what was found, where a layer of verification did not pass: whoever signs answers
/// for these very files. `remedy` says what to do; that nothing was signed is said here.
void require_passed(const std::filesystem::path& run_dir, const VerificationStep& step,
                    const std::string& remedy);

/// The same of the layers that look at files, chain, schemas, rules and report.
void require_signable(const std::filesystem::path& run_dir, const ReportFacts& report,
                      const std::string& remedy);

/// What a signature of the run is about to answer for, a line for each rule: its text, speed,
/// uncertainty and outcome. Failure where the verdict cannot be read.
std::vector<std::string> what_is_signed(const std::filesystem::path& run_dir);

}  // namespace runcert
