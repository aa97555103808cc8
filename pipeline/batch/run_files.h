#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "files/folder.h"

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
    /// What was found in the way of the batch's own files, and is not this user's batches'.
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
/// which new ones are made, so that the run folder stays whole until all are. A file counts by its
/// contents alone: whatever a name promises, it is hashed before it is used.
class RunFiles {
  public:
    /// Both are in the folder of results, by their names there, and neither need exist.
    RunFiles(std::filesystem::path results, const std::filesystem::path& run,
             std::filesystem::path work);

    const std::filesystem::path& run_dir() const { return run_dir_; }
    const std::filesystem::path& work_dir() const { return work_dir_; }

    /// Where a file of that name and SHA-256 is; nothing where neither folder holds it.
    std::optional<std::filesystem::path> find(const std::string& name, const std::string& sha256);

    /// Whether the run folder holds a file of that name and SHA-256.
    bool is_published(const std::string& name, const std::string& sha256);

    /// Whether either folder holds a regular file of that name.
    bool exists(const std::string& name) const;

    /// Takes away what a killed program left half written in either folder, and beside the run's.
    /// Failure where another program writes in the run folder.
    void remove_left() const;

    /// Makes the work folder, and takes out of it what is none of these files: a step reads there
    /// what is known by its hash. `known` may have several hashes of a name. A folder of that name
    /// that no batch of this user made is set aside.
    void open_work(const std::multimap<std::string, std::string>& known);

    /// Has the file of that SHA-256 in the work folder, as a link to the run folder's where the
    /// file system has links. It must be in one of the two.
    void bring_to_work(const std::string& name, const std::string& sha256);

    /// The SHA-256 of a file of the work folder that was just written there. Failure where it is
    /// not there.
    std::string written(const std::string& name);

    /// Has the files of these names and SHA-256 in a folder, of which each is in one of the two.
    void place(const std::map<std::string, std::string>& files, const Folder& to);

    /// Forgets what was hashed: another run was put in the run folder's place.
    void forget() { hashes_.clear(); }

    /// Takes the work folder away.
    void close_work();

  private:
    std::optional<std::string> hash_of(const std::filesystem::path& file);
    /// The file beside the work folder by which this user's batches know that they made it.
    std::string seal_name() const;
    bool is_own_work() const;
    std::string text_of_seal(const Folder& all) const;
    /// Whether the seal stands there without the folder that it is of.
    bool is_left_seal(const Folder& all) const;

    std::filesystem::path results_;
    std::filesystem::path run_dir_;
    std::filesystem::path work_;
    std::filesystem::path work_dir_;
    std::map<std::string, std::optional<std::string>> hashes_;
};

/// Moves an entry of a folder of results, which no batch of this user wrote, to the first free name
/// in what was superseded there.
void set_aside(const Folder& folder, const std::string& name, const std::filesystem::path& results);

/// Takes away what killed programs of this user left half written in a folder. Nobody may be
/// writing there.
void remove_temporaries(const std::filesystem::path& folder);

}  // namespace runcert
