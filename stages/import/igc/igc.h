#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// IGC flight logs: FAI/IGC, Technical Specification for GNSS Flight Recorders, second edition with
/// amendments, appendix A.
namespace runcert::igc {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Each B record is an
/// epoch. Records that cannot be read are counted and listed. Failure where it holds no epoch, or
/// most of it cannot be read.
///
/// The accuracy is that of the B records' extensions FXA and VXA, which give a probability of
/// 95.45 % ("2-sigma"): FXA as a radius, of a circular normal error. A recorder that writes one
/// figure for all fixes in its header (HFFXA) states none of the single fix, and so none here.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::igc
