#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "store/opaque_json.h"
#include "store/process.h"

namespace runcert {

/// Names of files, with the SHA-256 of each.
using FileHashes = std::map<std::string, std::string>;

/// The programs that a step depends on, by name, with the SHA-256 of each: its own, and those of
/// others that it calls; "none" for one that is not installed.
using StepPrograms = std::map<std::string, std::string>;

/// The programs of every step (`steps`), in the given folder and in those of the system. Failure
/// if a stage's own is missing.
std::map<std::string, StepPrograms> programs_of_steps(const std::filesystem::path& folder);

/// What a step's files were made from, and what they were.
struct StepRecord {
    StepPrograms programs{};
    OpaqueJson settings{};
    FileHashes inputs{};
    FileHashes outputs{};
    std::vector<std::string> said{};  ///< by the program, on standard output
    double seconds = 0.0;             ///< that it took
};

/// Why a run could not be made.
struct RunFailure {
    std::string step;
    std::string problem;
    std::string where;
    std::string remedy;

    bool operator==(const RunFailure&) const = default;
};

/// What is known of a run's steps by name, beside its files: a cache in the user's state folder
/// (user_state.h), without which all are done again.
using RunRecord = std::map<std::string, StepRecord>;

/// What is remembered of the run that has a file with that SHA-256, its report or a day's results,
/// wherever its folder is now; empty where there is nothing.
RunRecord recalled_record(const std::string& sha256);
/// Remembers it in place of that of the file before.
void remember_record(const std::string& sha256, const RunRecord& record,
                     const std::string& before = {});

/// Why the last call could not make the run of a folder from an attempt and what it names; nothing
/// where it could, or where these were others.
std::optional<RunFailure> recalled_failure(const std::filesystem::path& run_dir,
                                           const FileHashes& claim);
void remember_failure(const std::filesystem::path& run_dir, const FileHashes& claim,
                      const std::optional<RunFailure>& failure);

/// A step's program says a few lines. One that says more than so many bytes is ended before it
/// fills the memory.
inline constexpr std::size_t most_output_of_step = std::size_t{16} << 20;

/// In what the present programs, settings and inputs of a step differ from those before, in words
/// that name the first of them ("parameters: smooth.seed 1 -> 2"); empty where in nothing.
std::string what_changed(const StepRecord& before, const StepRecord& now);

/// What went wrong with a step's program: in its own words where it has said them, else how it
/// ended.
RunFailure failure_of_program(const std::string& step, const ProcessResult& result,
                              std::chrono::milliseconds time_limit);

}  // namespace runcert
