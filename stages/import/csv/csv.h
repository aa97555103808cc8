#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// Tables of delimited text, whose columns the attempt names (`columns`, `frame`, `time_format`).
namespace runcert::csv {

/// Whether the text looks like a table of delimited values; which column is what, no content
/// says.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Failure with line and
/// column on everything that is not understood, and at the receiver's place in the attempt where
/// the description does not fit.
///
/// UTM: `sigma_east`, `sigma_north` are taken along the grid's axes and in grid metres; they are
/// divided by the point scale and turned by the meridian convergence. Velocities are taken towards
/// true east and north, in metres a second on the ground, as receivers give them.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::csv
