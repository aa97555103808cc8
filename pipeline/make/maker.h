#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "make/given_attempt.h"
#include "make/progress.h"
#include "make/run_record.h"
#include "run/steps.h"
#include "trust/signature.h"

namespace runcert {

/// What all runs of a call have in common.
struct MakerOptions {
    /// `programs_of_steps` of that folder; asked for where something was made before, and kept.
    std::shared_future<std::map<std::string, StepPrograms>> programs = {};
    std::filesystem::path program_folder = runcert::program_folder();
    ReportChoice report = {};
    std::optional<SecretKey> key = std::nullopt;  ///< to sign with; then report.signer names it
    bool force = false;                           ///< every step again
    std::string from = {};                        ///< this step and all after it again
    std::optional<std::chrono::milliseconds> time_limit = {};  ///< of a step
    unsigned threads = 0;    ///< that a step may use; 0 for as many as it likes
    bool own_group = false;  ///< the terminal's Ctrl-C does not reach the steps
    /// One run alone: its pages are drawn beside its stages, report.pdf after it has its place.
    bool pages_ahead = false;
    std::optional<GpsTime> latest = std::nullopt;  ///< no recording may begin later
};

/// For runs with these pages, signed with the secret key in a file unless its name is empty, by the
/// programs beside this one.
MakerOptions maker_options(std::vector<std::string> pages, const std::string& key_file);

/// A run to be made.
struct RunOrder {
    const GivenAttempt& attempt;
    std::filesystem::path run_dir;
    bool is_named = false;  ///< the folder, by the user: it may be a link
};

/// What became of a run.
struct RunState {
    bool complete = false;     ///< all its files are in the run folder and up to date
    bool interrupted = false;  ///< a stop was requested before the end
    std::vector<StepReport> steps = {};
    std::vector<std::string> said = {};   ///< the check's line for each profile
    std::vector<std::string> signs = {};  ///< what was signed now, a line for each profile
    std::string superseded = {};          ///< the folder of an earlier run, within the run folder
    std::optional<RunFailure> failure = std::nullopt;
    FileHashes files = {};  ///< of the run folder, where it is complete
};

/// Told when a step begins, and when it has ended or is kept: `folder` holds its files then.
struct MakerWatch {
    std::function<void(const std::string& step)> begins = [](const std::string&) {};
    std::function<void(const StepReport& step, const StepRecord& record,
                       const std::filesystem::path& folder)>
        ends = [](const StepReport&, const StepRecord&, const std::filesystem::path&) {};
    /// The run has its place; with `pages_ahead`, report.pdf is still drawn.
    std::function<void()> published = [] {};
};

/// Makes what is missing of a run or was not made from its present programs, settings and inputs,
/// in a folder beside it, and lets the whole take the run's place when all is made. Everything is
/// judged by SHA-256: what a step was made from, and what it wrote. Killed at any moment it leaves
/// the earlier run or the new one. What goes wrong is in the state's failure.
RunState update_run(const RunOrder& order, const MakerOptions& options, const MakerWatch& watch,
                    const std::stop_token& stop);

/// How a run stands: the steps up to the first that `update_run` would run. Writes nothing. The
/// failure is that of the last call, if that step is the one that failed.
RunState inspect_run(const RunOrder& order, const MakerOptions& options);

}  // namespace runcert
