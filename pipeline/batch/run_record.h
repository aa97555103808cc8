#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/held_json.h"
#include "files/process.h"
#include "files/record_key.h"

namespace runcert {

/// The programs that a step of a run rests on, by name, with the SHA-256 of each: the stage's own,
/// and those of others that it calls; "none" for one that is not installed.
using StepPrograms = std::map<std::string, std::string>;

/// Those of every step (`steps`), from the folder of the stages and from those of the system. Each
/// program is read once. Failure where a stage's own is missing.
std::map<std::string, StepPrograms> programs_of_steps(const std::filesystem::path& folder);

/// The SHA-256 of a program: of the file of that path or, where it holds no slash, of the first of
/// that name in the folders of the system (`external_program_file`); "none" where there is none.
std::string program_hash(const std::string& program);

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

/// A step's program says a few lines; beyond so many bytes it says nonsense without end, and is
/// ended before it fills the memory.
inline constexpr std::size_t most_output_of_step = std::size_t{16} << 20;

/// What a step would now be made from that it was not made from before, in words ("parameters:
/// seed 1 -> 2"); empty where all is as it was. What was written is not looked at.
std::string what_changed(const StepRecord& before, const StepRecord& now);

/// The failure of a step whose program did not end well: its own three lines where it said them,
/// else how it ended.
RunFailure failure_of_program(const std::string& step, const ProcessResult& result,
                              std::chrono::milliseconds time_limit);

}  // namespace runcert
