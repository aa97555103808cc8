#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "store/folder.h"

namespace runcert {

/// Where a batch keeps what is its own, beside the run folders and the day's results.
struct BatchFolders {
    explicit BatchFolders(std::filesystem::path results) : out(std::move(results)) {}

    std::filesystem::path out;  ///< the day's results

    std::filesystem::path own() const { return out / ".runcert"; }
    /// What the steps of a run were made from.
    std::filesystem::path record(const std::string& id) const {
        return own() / "records" / (id + ".json");
    }
    /// A run in the making.
    std::filesystem::path work(const std::string& id) const { return own() / "work" / id; }
    /// What was in the way of the batch's own files and was not made by this user's batches.
    std::filesystem::path superseded() const { return own() / "superseded"; }
    /// The text of an attempt that a day file made.
    std::filesystem::path composed(const std::string& id) const {
        return own() / "attempts" / (id + ".yaml");
    }
    std::filesystem::path lock(const std::string& id) const {
        return own() / "locks" / (id + ".lock");
    }
    std::filesystem::path day_lock() const { return own() / "batch.lock"; }
    /// What became of each attempt, for the program that writes the day's results; and what these
    /// were made from.
    std::filesystem::path results_list() const { return own() / "results.json"; }
    std::filesystem::path results_record() const { return own() / "results-record.json"; }
    std::filesystem::path slurm() const { return own() / "slurm"; }
};

/// The files of a run while it is made: those of its run folder, and those of a work folder in
/// which new ones are made, so that the run folder stays whole until all are done. Only contents
/// count: a file is hashed before it is used.
class RunFiles {
  public:
    /// `run` and `work` are paths within the folder of results; neither need exist.
    RunFiles(std::filesystem::path results, const std::filesystem::path& run,
             std::filesystem::path work);

    const std::filesystem::path& run_dir() const { return run_dir_; }
    const std::filesystem::path& work_dir() const { return work_dir_; }

    /// Where a file of that name and SHA-256 is; nothing if neither folder holds it.
    std::optional<std::filesystem::path> find(const std::string& name, const std::string& sha256);

    /// Whether the run folder holds a file of that name and SHA-256.
    bool is_published(const std::string& name, const std::string& sha256);

    /// Whether either folder holds a regular file of that name.
    bool exists(const std::string& name) const;

    /// Removes what a killed program left half written in either folder, and beside the run folder.
    /// Failure if another program writes in the run folder.
    void remove_left() const;

    /// Makes the work folder, and removes from it all but the files that `known` names with their
    /// hash, of which there may be several for a name. A folder of that name that no batch of this
    /// user made is set aside.
    void open_work(const std::multimap<std::string, std::string>& known);

    /// Puts the file with that SHA-256, which must be in one of the two folders, into the work
    /// folder: as a hard link where the file system has links.
    void bring_to_work(const std::string& name, const std::string& sha256);

    /// The SHA-256 of a file that was just written in the work folder. Failure if there is none.
    std::string written(const std::string& name);

    /// Puts the files of these names and SHA-256, each of which is in one of the two folders, into
    /// another one.
    void place(const std::map<std::string, std::string>& files, const Folder& to);

    /// Forgets the hashes: another run has taken the run folder's place.
    void forget() { hashes_.clear(); }

    /// Removes the work folder.
    void close_work();

  private:
    std::optional<std::string> hash_of(const std::filesystem::path& file);
    /// The file beside the work folder that shows this user's batches that they made it.
    std::string seal_name() const;
    bool is_own_work() const;
    std::string text_of_seal(const Folder& all) const;
    /// Whether the seal is there and its folder is not.
    bool is_left_seal(const Folder& all) const;

    std::filesystem::path results_;
    std::filesystem::path run_dir_;
    std::filesystem::path work_;
    std::filesystem::path work_dir_;
    std::map<std::string, std::optional<std::string>> hashes_;
};

/// Moves an entry of a folder of results that no batch of this user wrote to the first free name
/// among what was superseded there.
void set_aside(const Folder& folder, const std::string& name, const std::filesystem::path& results);

/// Removes what killed programs of this user left half written in a folder in which nobody writes.
void remove_temporaries(const std::filesystem::path& folder);

}  // namespace runcert
