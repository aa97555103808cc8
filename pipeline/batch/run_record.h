#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/programs.h"
#include "files/held_json.h"

namespace runcert {

/// What a step's files were made from, and what they were.
struct StepRecord {
    StepPrograms programs;
    HeldJson settings;
    std::map<std::string, std::string> inputs;   ///< file to SHA-256
    std::map<std::string, std::string> outputs;  ///< file to SHA-256
    std::vector<std::string> said;               ///< by the program, on standard output
    double seconds = 0.0;                        ///< that it took
};

/// Why a run could not be made.
struct RunFailure {
    std::string step;
    std::string problem;
    std::string where;
    std::string remedy;

    bool operator==(const RunFailure&) const = default;
};

/// What is known of a run's steps, beside the files themselves.
struct RunRecord {
    std::map<std::string, StepRecord> steps;
    std::optional<RunFailure> failure;
    /// Files of the run folder that were put there and are to be taken away when they are no longer
    /// part of the run.
    std::vector<std::string> published;
};

/// Reads a record. One that is missing, or is not, byte for byte, what was written, is as good as
/// none: the run is then recomputed.
RunRecord read_run_record(const std::filesystem::path& file);

/// Writes a record with a checksum of its own, by which `read_run_record` knows it. Atomically
/// where files were published. Failure where it cannot be written.
void write_run_record(const std::filesystem::path& file, const RunRecord& record);

}  // namespace runcert
