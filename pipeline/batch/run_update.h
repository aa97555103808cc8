#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "batch/claim.h"
#include "batch/day_attempts.h"
#include "batch/progress.h"
#include "batch/run_record.h"
#include "run/steps.h"
#include "trust/signature.h"

namespace runcert {

/// What all runs of a batch have in common.
struct BatchContext {
    std::filesystem::path out;             ///< run folders are OUT/ID
    std::filesystem::path program_folder;  ///< of the stages
    std::map<std::string, StepPrograms> programs = {};
    ReportChoice report = {};
    std::optional<SecretKey> key = std::nullopt;  ///< to sign with; then report.signer names it
    bool force = false;                           ///< every step again
    std::string from = {};                        ///< this step and all after it again
    std::chrono::milliseconds time_limit = std::chrono::minutes(10);  ///< of a step
    unsigned threads = 1;                                             ///< that a step may use
    /// Seals the records of the runs. A record that it did not seal is as if it were not there.
    RecordKey record_key = {};
};

/// What became of a run.
struct RunState {
    bool complete = false;     ///< all its files are in the run folder, and of now
    bool interrupted = false;  ///< a stop was requested before the end
    std::vector<StepReport> steps = {};
    std::vector<std::string> said = {};   ///< the check's line for each profile
    std::vector<std::string> signs = {};  ///< what was signed now, a line for each profile
    std::optional<RunFailure> failure = std::nullopt;
    FileHashes files = {};  ///< of the run folder, where it is complete
    /// Whether its record is not this user's: it tells nothing, and the run is made again.
    bool foreign_record = false;
};

/// Asked before the first step of a run that is done, with about how many epochs its recordings
/// hold: false leaves the run as it is. Told when a step begins, and when it has ended or is kept.
struct StepWatch {
    std::function<bool(std::uint64_t epochs)> admitted = [](std::uint64_t) { return true; };
    std::function<void(const std::string& step)> begins = [](const std::string&) {};
    std::function<void(const StepReport& step)> ends = [](const StepReport&) {};
};

/// Makes what of a run is missing, or not of its present programs, settings and inputs, in the work
/// folder, and puts it into the run folder when all is made. Everything is judged by SHA-256: what
/// a step was made from, and what it wrote. Killed at any moment it leaves whole files, and goes on
/// at the next call from the last step that ended. What goes wrong is in the state's failure.
RunState update_run(const DayAttempt& attempt, const BatchContext& context, const StepWatch& watch,
                    const std::stop_token& stop);

/// How a run stands: the steps up to the first that `update_run` would do. Writes nothing. The
/// failure is that of the last time, where that step is the one that failed.
RunState inspect_run(const DayAttempt& attempt, const BatchContext& context);

}  // namespace runcert
