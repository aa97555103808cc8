#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace runcert {

/// What comparing a run folder's pages with those that this program renders gave.
struct PageComparison {
    bool passed = true;
    std::vector<std::string> details{};  ///< a line for each page
};

/// Renders the pages of a run folder's report.json again in `folder`, which holds the run's files,
/// with the signatures that report.html carries, and compares. Not passed where report.html shows
/// other text than this very program makes; another program's page, other drawings (gnuplot's
/// version) and another PDF (fonts, a seal) are said, and left to the reader.
PageComparison compare_pages(const std::filesystem::path& run_dir,
                             const std::filesystem::path& folder);

}  // namespace runcert
