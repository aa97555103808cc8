#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/import/measured_epoch.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

/// Goes through RINEX observations (2.10 to 2.12 [RINEX2], 3.00 to 4.02 [RINEX3]) epoch by epoch:
/// GPS and Galileo; other systems are counted and set aside. Version 2 names no attributes: L1 is
/// taken for 1C where C1 is among the types, else for 1W; L2 for 2W where P2 is, else for 2X;
/// Galileo's for X.
///
/// An epoch that cannot be read is a bad record, and reading goes on at the next. A phase whose
/// half cycle is open (bit 1 of the indicator) says so. Failure with the line where the header is
/// not understood: another version, no types, a scale factor, an unknown time system; and where
/// most records cannot be read.
MeasurementFacts read_measurements(const RecordingBytes& recording, const TakeMeasurements& take);

}  // namespace runcert::rinex
