#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace runcert {

inline constexpr const char* report_file = "report.json";

/// How a file of a run folder stands to the same one made again.
struct FileComparison {
    std::string file;
    std::string stage;  ///< that writes it
    bool identical = false;
    /// The first difference that is not tolerated: where, and both values.
    std::optional<std::string> first = std::nullopt;
    double largest_ratio = 0.0;  ///< of what is: to its standard uncertainty
    std::string where_largest = {};
    std::string maker = {};  ///< of the folder's file; empty where it is this program

    /// "4-trajectory.ecsv, line 360, column speed: 62.1 in the folder, 62.2 recomputed"
    std::string sentence() const { return file + ", " + first.value_or(""); }
};

/// Compares a product, or report.json, of two folders. What says who made it from which bytes is
/// not compared.
FileComparison compare_file(const std::filesystem::path& run_dir,
                            const std::filesystem::path& recomputed, const std::string& name);

}  // namespace runcert
