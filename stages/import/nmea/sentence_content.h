#pragma once

#include "stages/import/nmea/epoch.h"

/// What the fields of each sentence say. Layouts: NMEA 0183 version 4.11, section 6.3, as u-blox'
/// "F9 HPG interface description" (UBX-22008968) and the gpsd project's "NMEA Revealed" give them.
/// All fail at the field that they cannot read.
namespace runcert::nmea {

/// Failure for a sentence with fewer fields than its type must have, and than it has in full where
/// no checksum shows that it is whole.
void require_whole(const Sentence& sentence);

/// A position only where the quality says that there is one.
Solution read_gga(const Sentence& gga);
Solution read_gns(const Sentence& gns);
/// Position (without height), velocity and date of an RMC sentence, all or nothing.
void take_in_rmc(const Sentence& rmc, Epoch& epoch);

/// Empty where the receiver says that it is not valid.
GroundVelocity read_vtg(const Sentence& vtg);

ErrorStatistics read_gst(const Sentence& gst);

/// Counts one of an epoch's lists of satellites by its mode.
void take_in_gsa(const Sentence& gsa, Epoch& epoch);

}  // namespace runcert::nmea
