#pragma once

#include <filesystem>

#include "trust/verification.h"

namespace runcert {

/// Makes report.json again from the folder's stage files: it must be the same, byte for byte; of
/// another program, or with another mathematical library, in all that it says of the measurement.
VerificationStep verify_report_text(const std::filesystem::path& run_dir,
                                    const ReportFacts& report);

/// Runs all stages again, from the run folder's own copies of attempt, profiles and recordings, and
/// compares every stage file with the folder's.
/// The finding is one of three: identical; equal within a thousandth of the stated uncertainty
/// (where there is none: one unit of the last declared digit), windows and verdict much closer
/// unless the library or the processor is another than the report states, which is then said;
/// different, with the first stage in the order of the chain, the file, line and column, and both
/// values. The details say what else differs, and who made the folder's files if it was another
/// program.
VerificationStep verify_recomputation(const std::filesystem::path& run_dir,
                                      const ReportFacts& report);

}  // namespace runcert
