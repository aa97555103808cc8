#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "files/process.h"
#include "run/steps.h"

namespace runcert {

/// A stage that ran: its name, what it said, and how long it took (s).
struct StageDone {
    std::string name;
    std::vector<std::string> said;
    double seconds = 0.0;
};

/// A stage that could not do its work: its own message is in `errors`, ready for the user.
struct StageFailed {
    std::string name;
    std::string errors;
};

/// Runs the program of a step to its end. Throws StageFailed where it ends with status 2, Failure
/// where it ends in any other way but well.
StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options = {});

/// The stages from import to check, each on the attempt and run folder given; `earlier_run`, if not
/// empty, is a run folder to take recordings and profiles from. `done` is called after each. What
/// they write is not synced.
void run_stages(const std::filesystem::path& attempt, const std::filesystem::path& run_dir,
                const std::filesystem::path& earlier_run,
                const std::function<void(const StageDone&)>& done);

}  // namespace runcert
