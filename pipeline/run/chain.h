#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/process.h"
#include "run/run_lock.h"
#include "run/steps.h"

namespace runcert {

/// A stage that ran: its name, what it said, and how long it took (s).
struct StageDone {
    std::string name;
    std::vector<std::string> said;
    double seconds = 0.0;
};

/// A stage that could not do its work: its own message is in `errors`, ready for the user.
struct StageFailed {
    std::string name;
    std::string errors;
};

/// Runs the program of a step to its end. Throws StageFailed where it ends with status 2, Failure
/// where it ends in any other way but well.
StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options = {});

/// The stages from import to check, each on the attempt and run folder given; `earlier_run`, if not
/// empty, is a run folder to take recordings and profiles from. `done` is called after each. What
/// they write is not synced.
void run_stages(const std::filesystem::path& attempt, const std::filesystem::path& run_dir,
                const std::filesystem::path& earlier_run,
                const std::function<void(const StageDone&)>& done);

/// A folder inside a run folder in which new results are made, so that earlier ones stay whole
/// until all new ones are. Removed at the end with what is left in it, and the run folder too if it
/// did not exist before and holds nothing. Meanwhile it holds the run folder's lock.
class StagingFolder {
  public:
    explicit StagingFolder(std::filesystem::path run_dir);
    ~StagingFolder();
    StagingFolder(const StagingFolder&) = delete;
    StagingFolder& operator=(const StagingFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    /// Moves every file into the run folder. The report goes first out and last in, so that a run
    /// folder with a report is never half old and half new.
    void publish();

  private:
    std::filesystem::path run_dir_;
    std::filesystem::path path_;
    bool created_run_dir_ = false;
    std::optional<RunLock> lock_;  ///< of the run folder
};

}  // namespace runcert
