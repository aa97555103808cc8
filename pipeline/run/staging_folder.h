#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "run/run_lock.h"
#include "store/folder.h"

namespace runcert {

/// A folder in which a new run is made while the earlier one stays whole, and which is then
/// exchanged for it. Meanwhile it holds the run folder's lock.
///
/// It lies beside the run folder, in `.runcert-...`, and one rename exchanges the two: whoever
/// looks, and whenever the program is killed, finds the earlier run or the new one. What is left of
/// the one that lost is removed, after a kill by the same user's next call (`clear_abandoned`).
///
/// Where a folder cannot be exchanged (a disk is mounted there, this program runs in it, it holds
/// folders of the user's, its parent may not be written, its file system has no such rename), the
/// new run is made inside it, and its files are put in place one by one, report.json out first and
/// in last: a kill in the midst leaves no report.json, and what was superseded is there already.
class StagingFolder {
  public:
    /// For the run folder that a user named, which is made where it is missing and may be a link.
    /// Failure where another program writes there, and where no folder can be made.
    explicit StagingFolder(const std::filesystem::path& run_dir);
    /// For one in a folder of results, where it is no symbolic link.
    StagingFolder(const Folder& parent, const std::string& name);
    /// Removes what was not published, and the run folder too if it was made here and is empty.
    ~StagingFolder();
    StagingFolder(const StagingFolder&) = delete;
    StagingFolder& operator=(const StagingFolder&) = delete;

    /// Where the new run is made.
    const std::filesystem::path& path() const { return staged_->path(); }
    const Folder& folder() const { return *staged_; }
    /// The earlier run, empty where there is none.
    const Folder& earlier() const { return *run_; }

    /// Syncs the new run and lets it take the earlier one's place; what is to stay of that must be
    /// in the new one already. Failure where this cannot be done; the earlier run then stands.
    void publish();

  private:
    struct Place {
        Folder parent;
        std::string name;
        bool created = false;
    };
    explicit StagingFolder(Place place);
    const Folder& around() const { return inside_ ? *run_ : parent_; }

    Folder parent_;
    std::string name_;
    bool created_ = false;
    std::optional<RunLock> lock_;  ///< of the run folder
    std::optional<Folder> run_;
    bool inside_ = false;
    std::string own_name_;       ///< of the folder that holds the staged one
    std::optional<Folder> own_;  ///< locked: nobody else takes it for a killed program's
    FileDescriptor own_lock_;
    std::optional<Folder> staged_;  ///< the programs of the stages lock it
};

/// What this user's last call put into a run folder, or was putting there when it was killed.
struct Published {
    std::string report_sha256{};
    std::vector<std::string> names{};
};
/// Empty where that is not known.
Published last_published(const std::filesystem::path& run_dir);

/// Removes the staging folders that killed programs of this user left in a folder and at which none
/// is at work.
void clear_abandoned(const Folder& folder);

}  // namespace runcert
