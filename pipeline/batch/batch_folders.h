#pragma once

#include <filesystem>
#include <string>

namespace runcert {

/// Where a batch keeps what is its own, beside the run folders and the day's results.
struct BatchFolders {
    explicit BatchFolders(std::filesystem::path results) : out(std::move(results)) {}

    std::filesystem::path out;  ///< the day's results

    std::filesystem::path own() const { return out / ".runcert"; }
    std::filesystem::path run(const std::string& id) const { return out / id; }
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

}  // namespace runcert
