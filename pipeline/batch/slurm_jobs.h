#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace runcert {

/// A day handed to a cluster: a job array that makes the runs, and a job after it that makes the
/// results. Kept in a file, so that a later call finds them; of jobs that ended it does no harm.
struct SlurmJobs {
    std::string array;      ///< id of the job array
    std::string gatherer;   ///< id of the job that makes the results
    std::string cluster;    ///< name, where --clusters chose one; else empty
    std::size_t tasks = 0;  ///< of the array
    std::size_t runs = 0;   ///< that the tasks share

    bool operator==(const SlurmJobs&) const = default;
};

/// Writes the file; Failures as for write_file_atomically.
void write_slurm_jobs(const std::filesystem::path& file, const SlurmJobs& jobs);

/// What write_slurm_jobs wrote; nothing where there is no such file. Failure, which says to remove
/// it, where it holds anything else.
std::optional<SlurmJobs> read_slurm_jobs(const std::filesystem::path& file);

/// How the tasks of a job stand.
struct JobState {
    std::size_t pending = 0;   ///< not begun, or to be begun again; held ones too
    std::size_t running = 0;   ///< begun and not ended
    std::size_t over = 0;      ///< no longer known as pending or running, however they ended
    std::size_t held = 0;      ///< of the pending: those that wait until someone releases them
    std::size_t requeued = 0;  ///< of the pending and running: begun at least twice, e.g. because a
                               ///< node failed
    std::map<std::string, std::size_t> reasons = {};  ///< of the pending, in Slurm's own words

    bool is_over() const { return pending + running == 0; }
};

/// "submitted job 12, 40 tasks for 200 runs; results by job 13", and how to see them and end them;
/// lines for people, each ended.
std::string submission_text(const SlurmJobs& jobs);

/// How both jobs stand; lines for people, each ended.
std::string status_text(const SlurmJobs& jobs, const JobState& array, const JobState& gatherer);

}  // namespace runcert
