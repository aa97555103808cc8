#pragma once

#include <vector>

#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// Failure where a recording cannot be of these files, whatever they hold: more than 127, or one
/// that is given twice. For before they are read.
void require_joinable(const std::vector<RecordingBytes>& recordings);

/// The parts of a recording, read from files that follow one another, as one: see
/// `import_recordings`. `parts` and `recordings` go together, at least one; a single part is
/// returned as it is.
Observations join(std::vector<Observations> parts, const std::vector<RecordingBytes>& recordings);

}  // namespace runcert
