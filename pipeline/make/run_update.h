#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "make/claim.h"
#include "make/day_attempts.h"
#include "make/progress.h"
#include "make/run_record.h"
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
    /// Seals the records of the runs; a record that it did not seal is ignored.
    RecordKey record_key = {};
    std::optional<GpsTime> latest = std::nullopt;  ///< no recording may begin later
};

/// What became of a run.
struct RunState {
    bool complete = false;     ///< all its files are in the run folder and up to date
    bool interrupted = false;  ///< a stop was requested before the end
    std::vector<StepReport> steps = {};
    std::vector<std::string> said = {};   ///< the check's line for each profile
    std::vector<std::string> signs = {};  ///< what was signed now, a line for each profile
    std::optional<RunFailure> failure = std::nullopt;
    FileHashes files = {};  ///< of the run folder, where it is complete
    /// Its record was not sealed by this user and was not read: the run is made again.
    bool foreign_record = false;
};

/// Told when a step begins, and when it has ended or is kept.
struct StepWatch {
    std::function<void(const std::string& step)> begins = [](const std::string&) {};
    std::function<void(const StepReport& step)> ends = [](const StepReport&) {};
};

/// Makes in the work folder what is missing of a run or was not made from its present programs,
/// settings and inputs, and puts the whole into the run folder when all is made. Everything is
/// judged by SHA-256: what a step was made from, and what it wrote. Killed at any moment it leaves
/// whole files, and the next call goes on from the last step that ended. What goes wrong is in the
/// state's failure.
RunState update_run(const DayAttempt& attempt, const BatchContext& context, const StepWatch& watch,
                    const std::stop_token& stop);

/// How a run stands: the steps up to the first that `update_run` would run. Writes nothing. The
/// failure is that of the last call, if that step is the one that failed.
RunState inspect_run(const DayAttempt& attempt, const BatchContext& context);

}  // namespace runcert
