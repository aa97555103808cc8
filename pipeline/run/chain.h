#pragma once

#include <ctime>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "run/attempt_files.h"
#include "run/steps.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert {

/// A step that was done: its name, what it said, how long it took (s), and the files that it wrote.
struct StageDone {
    std::string name;
    std::vector<std::string> said = {};
    double seconds = 0.0;
    std::vector<std::string> wrote = {};
};

/// A step whose program did not end well.
struct StageFailed {
    std::string name;
    ProcessResult result;
};

/// The three lines that every program of this project prints on standard error when it fails: what,
/// where, what to do. None where these are not the last ones.
std::vector<std::string> own_words(const std::string& errors);

/// What the program told the user, if it ended with status 2. Failure if it ended in any other way,
/// and ComputerFailure where it says that one ended it.
std::string message_of(const StageFailed& failed);

/// Which of the programs of others that the step calls did not do its work: it is missing, or said
/// so. Nothing where the step ended for something else, such as what it read.
std::optional<std::string> failed_call(const StageFailed& failed);

/// Runs the program of a step to its end. Throws StageFailed where it did not end well.
StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options = {},
                   const std::filesystem::path& programs = program_folder());

/// A run that is made in a folder.
struct RunInMaking {
    const Attempt& attempt;
    std::string_view text;  ///< of the attempt
    AttemptSource source;   ///< where that was read, and where what it names is
    std::filesystem::path folder;
    std::filesystem::path known_as;  ///< what messages call that folder
    ReportChoice report = {};
    std::filesystem::path programs = program_folder();
    /// How the programs are run. What they write is synced by the caller.
    ProcessOptions process = {.environment = {synced_by_caller()}};
    std::optional<GpsTime> latest = std::nullopt;  ///< no recording may begin later
    std::function<std::string()> sign = {};        ///< signs the report; the signature's name
    std::function<StageDone()> draw = {};          ///< draws the pages; empty: its program does
};

/// The end of tomorrow by the computer's clock, but for the leap seconds.
GpsTime end_of_tomorrow(std::time_t now);

/// Makes a run by the table of steps: each that is part of a run reported so and of which `stays`
/// is false. `done` is called after each. Throws what the steps throw; Failure where a recording
/// begins after `latest`, before any other step.
void make_run(const RunInMaking& run, const std::function<bool(const Step&)>& stays,
              const std::function<void(const StageDone&)>& done);

inline constexpr const char* run_times_name = "run.yaml";
/// run.yaml: when a run was made, and how long its stages took; no other file depends on it.
std::string run_times_text(std::time_t started, const std::vector<StageDone>& stages);

}  // namespace runcert
