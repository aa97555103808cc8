#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "store/held_json.h"
#include "store/process.h"
#include "store/record_key.h"

namespace runcert {

/// The programs that a step depends on, by name, with the SHA-256 of each: its own, and those of
/// others that it calls; "none" for one that is not installed.
using StepPrograms = std::map<std::string, std::string>;

/// The programs of every step (`steps`), in the given folder and in those of the system. Failure
/// if a stage's own is missing.
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
    /// Files that were put into the run folder, to be removed when the run no longer has them.
    std::vector<std::string> published;
    /// Whether there is a record that the key did not seal, of which nothing was read.
    bool foreign = false;
};

/// Where a record is, what it is about, and the key that seals it.
struct RecordPlace {
    std::filesystem::path file;
    std::string of;  ///< "run ID", "day": sealed too, since its file could be renamed
    const RecordKey& key;
};

/// Reads a record; empty if there is none. One that the key did not seal, byte for byte and
/// about this very thing, is not read: anyone could have written it, and the run is recomputed.
RunRecord read_run_record(const RecordPlace& place);

/// Seals and writes a record, and syncs it if files were published. Failure if it cannot be
/// written.
void write_run_record(const RecordPlace& place, const RunRecord& record);

/// A step's program says a few lines. One that says more than so many bytes is ended before it
/// fills the memory.
inline constexpr std::size_t most_output_of_step = std::size_t{16} << 20;

/// In what the present programs, settings and inputs of a step differ from those before, in words
/// ("parameters: seed 1 -> 2"); empty if they do not. Outputs are not compared.
std::string what_changed(const StepRecord& before, const StepRecord& now);

/// The failure of a step whose program did not end well: what it said itself in three lines, or
/// else how it ended.
RunFailure failure_of_program(const std::string& step, const ProcessResult& result,
                              std::chrono::milliseconds time_limit);

}  // namespace runcert
