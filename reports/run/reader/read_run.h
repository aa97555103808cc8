#pragma once

#include "reports/run/run_view.h"
#include "run/stage_run.h"

namespace runcert {

/// How much of a run is read.
enum class Reading {
    whole,         ///< for a report: what is missing is a Failure; IMU and surface are hashed alone
    what_is_there  ///< for an audit, with every file that a product names
};

/// Reads a run folder. All hashes that its files name of one another are held against the files.
RunView read_run_view(StageRun& run, Reading reading);

}  // namespace runcert
