#pragma once

#include <memory>

#include "batch/progress.h"

// The ways in which progress is shown, one file each; for make_progress alone.

namespace runcert {

/// Plain, and quiet where the options say so.
std::unique_ptr<Progress> make_plain_progress(const ProgressOptions& options);
std::unique_ptr<Progress> make_json_progress(const ProgressOptions& options);
std::unique_ptr<Progress> make_terminal_progress(const ProgressOptions& options);

}  // namespace runcert
