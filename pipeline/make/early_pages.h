#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/chain.h"
#include "store/process.h"

namespace runcert {

/// The pages of a run in making. What draws them is started while the run is measured, since
/// starting takes it longer than drawing the first page, and waits for the report; report.pdf,
/// which takes longest, is drawn in a folder of its own, for when the run has its place.
class EarlyPages {
  public:
    /// `pages`: which of `page_names`, of a run that is made in that folder.
    EarlyPages(const std::filesystem::path& run_dir, const std::vector<std::string>& pages);
    ~EarlyPages();
    EarlyPages(const EarlyPages&) = delete;
    EarlyPages& operator=(const EarlyPages&) = delete;

    /// The report is about to be made: starts what draws the whole, if that was not begun.
    void expect_whole();
    /// Draws all pages but report.pdf into the run's folder; that is begun. Throws StageFailed.
    StageDone draw();
    /// Waits for report.pdf, if it is one of the pages, and puts it into a folder. True where it
    /// did. Throws StageFailed.
    bool put_whole_into(const std::filesystem::path& run_dir);

  private:
    class Waiting;

    std::filesystem::path run_dir_;
    std::vector<std::string> first_pages_;
    bool has_whole_;
    TemporaryFolder folder_;
    std::unique_ptr<Waiting> first_, whole_;
};

}  // namespace runcert
