#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/programs.h"
#include "files/held_json.h"
#include "files/record_key.h"

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
    /// Whether a record is there that the key did not seal; nothing of it was read.
    bool foreign = false;
};

/// Where a record is, whose it is, and by whom it was made.
struct RecordPlace {
    std::filesystem::path file;
    std::string of;  ///< "run ID", "day": what it is of counts, not the name of its file
    const RecordKey& key;
};

/// Reads a record. One that is missing is none. One that the key did not seal, byte for byte and of
/// this very thing, says nothing: anyone could have written it, and the run is recomputed.
RunRecord read_run_record(const RecordPlace& place);

/// Writes a record and seals it. Atomically where files were published. Failure where it cannot be
/// written.
void write_run_record(const RecordPlace& place, const RunRecord& record);

}  // namespace runcert
