#pragma once

#include "files/folder.h"

// A new run that is put in a run folder's place file by file (staging_folder.h). It lies whole in a
// folder in it until all are.

namespace runcert {

/// What that folder is called, and the folder in it that holds the run.
inline constexpr const char* ready_name = ".runcert-ready";
inline constexpr const char* staged_name = "run";

/// Writes the record of a run that is complete in `own`/run, which is about to be called ready: of
/// which folders it is, and which files of the run folder go or are replaced, with their SHA-256;
/// sealed by this user's secret (record_key.h).
void write_ready_record(const Folder& run, const Folder& own);

/// Gives a run folder the contents of the run that is ready in it. It may have been begun before.
/// Failure, and nothing is changed, where what is there is not of that record, and where something
/// was put since in the way of what is to be put in place.
void finish_in_place(const Folder& run);

}  // namespace runcert
