#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "trust/verification.h"

namespace runcert {

/// The name of the measurement report in a run folder.
inline constexpr const char* report_file = "report.json";

/// How a file of a run folder stands to the same one made again.
struct FileComparison {
    std::string file;
    std::string stage;  ///< that writes it
    bool identical = false;
    /// The first difference that is not tolerated: where, and both values.
    std::optional<std::string> first = std::nullopt;
    /// Of the tolerated differences the largest ratio, no unit, and the place of that value.
    double largest_ratio = 0.0;  ///< of what is: to its standard uncertainty
    std::string where_largest = {};
    std::string maker = {};  ///< of the folder's file; empty where it is this program

    /// "4-trajectory.ecsv, line 360, column speed: 62.1 in the folder, 62.2 recomputed"
    std::string sentence() const { return file + ", " + first.value_or(""); }
};

/// Compares a product, or report.json, of two folders. Types, resolutions and uncertainties are the
/// recomputed file's and this program's declarations. Figures of the windows and of the verdict
/// must agree to a millionth of their uncertainty or 1e-9 of themselves where the folder's were
/// computed by `same_arithmetic`; a report, which follows from its files, to the letter. Where the
/// folder's file says that this very program made it, with the same arithmetic, every byte must be
/// the same. What says who made it from which bytes is not compared. A file that is missing in
/// one folder, or cannot be understood, is a difference and no Failure; one that cannot be opened
/// is a Failure.
FileComparison compare_file(const std::filesystem::path& run_dir,
                            const std::filesystem::path& recomputed, const std::string& name,
                            bool same_arithmetic);

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
/// program. Not checkable where import needs a program that is not here: the later stages are then
/// run on what it made, and must agree.
VerificationStep verify_recomputation(const std::filesystem::path& run_dir,
                                      const ReportFacts& report);

}  // namespace runcert
