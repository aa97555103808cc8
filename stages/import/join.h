#pragma once

#include <vector>

#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// The parts of a recording, read from files that follow one another, as one: see
/// `import_recordings`. `parts` and `recordings` go together, at least one; a single part is
/// returned as it is.
Observations join(std::vector<Observations> parts, const std::vector<RecordingBytes>& recordings);

}  // namespace runcert
