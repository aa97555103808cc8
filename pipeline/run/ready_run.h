#pragma once

#include "store/folder.h"

// A new run that is put in a run folder's place file by file (staging_folder.h). It lies whole in a
// folder in it until all are.

namespace runcert {

/// What that folder is called, and the folder in it that holds the run.
inline constexpr const char* ready_name = ".runcert-ready";
inline constexpr const char* staged_name = "run";

/// Writes the record of a run that is complete in `own`/run and about to be called ready: which
/// folders it belongs to, and which files of the run folder are removed or replaced, with their
/// SHA-256; sealed by this user's secret (record_key.h).
void write_ready_record(const Folder& run, const Folder& own);

/// Gives a run folder the contents of the run that is ready in it; an earlier call may have begun
/// to. Failure, and nothing is changed, where what is there does not belong to that record, or
/// something was put since where a file is to go.
void finish_in_place(const Folder& run);

}  // namespace runcert
