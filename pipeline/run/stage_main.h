#pragma once

#include <functional>
#include <string>

#include "run/command_line.h"
#include "run/stage_run.h"

namespace runcert {

/// Runs `body` as a program's main: a Failure is printed on standard error in three lines (what,
/// where, what to do) and gives exit status 2; so does memory that runs out.
int guarded_main(const std::function<int()>& body);

/// Main of a stage program: reads `--attempt ATTEMPT.yaml --run-dir DIR` (and what `options` adds),
/// runs the stage, prints what it says. `summary` is the first line of --help.
int stage_main(int argc, char** argv, const std::string& stage, const std::string& summary,
               const std::function<void(StageRun&)>& body,
               const std::function<void(CommandLine&)>& options = {});

/// Main of a program that looks at what the stages wrote: `options` adds to its command line, `run`
/// gives its exit status.
int reader_main(int argc, char** argv, const std::string& name, const std::string& summary,
                const std::function<void(CommandLine&)>& options, const std::function<int()>& run);

}  // namespace runcert
