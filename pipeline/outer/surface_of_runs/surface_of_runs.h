#pragma once

#include <span>
#include <string>
#include <vector>

#include "schemas/screened/screened.h"
#include "schemas/surface/declared.h"

namespace runcert {

/// An earlier run over a course.
struct EarlierRun {
    std::string id;                       ///< of its attempt
    std::vector<std::string> recordings;  ///< SHA-256 of its recording's files
    const ScreenedTable* positions = nullptr;
    double antenna_height_m = 0.0;
};

/// The surface under the usable positions of earlier runs, where there are some on both sides
/// (`fit_height_grid`). Positions count where the craft moved at 2 m/s or more; each with its
/// stated vertical standard deviation, 2 cm where none is stated. The standard deviation of the
/// vertices is the scatter of the positions about the surface, at least 1 cm: what all runs have in
/// common, such as the base station's height, is not in it. The caller sets the header.
///
/// Failure (at "surface") where two runs have a recording in common, some lie on the Earth and
/// others do not, heights were not measured, or nothing is left between the passes.
SurfaceTable surface_of_runs(std::span<const EarlierRun> runs);

}  // namespace runcert
