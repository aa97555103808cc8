#pragma once

#include <string_view>
#include <vector>

#include "satellites/ephemeris.h"
#include "stages/import/measured_epoch.h"
#include "stages/import/recording.h"

namespace runcert::ubx {

/// The raw measurements of a recording, and the ephemerides of its navigation messages.
struct RawFile {
    MeasurementFacts facts;
    std::vector<Ephemeris> ephemerides;
};

/// Whether the beginning of a recording has an RXM-RAWX message.
bool has_raw(std::string_view bytes);

/// Goes through RXM-RAWX epoch by epoch, and collects ephemerides of RXM-SFRBX (GPS LNAV, Galileo
/// I/NAV): u-blox "F9 HPG interface description" (UBX-22008968), sections 3.17.9 and 3.17.10,
/// [IS-GPS-200] 20.3.3, [GAL-ICD] 4.3. Other systems and messages are counted and set aside.
///
/// A phase whose lock time went down, or is shorter than the step, has lost its lock; one whose
/// half cycle is not resolved says so. Failure where there are no measurements, and where most
/// records cannot be read.
RawFile read_raw(const RecordingBytes& recording, const TakeMeasurements& take);

}  // namespace runcert::ubx
