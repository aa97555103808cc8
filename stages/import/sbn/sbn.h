#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// Locosys SBN logs, and any other log of SiRF binary messages: frames of 0xA0A2, length, payload,
/// checksum, 0xB0B3, the most significant byte first. Each message 41 (geodetic navigation data) is
/// an epoch; the others are passed over. Layout: SiRF Binary Protocol Reference Manual 2.4,
/// "Geodetic Navigation Data - Message ID 41", and for the six bytes that Locosys adds Logiqx,
/// "SBN - SiRF Binary".
namespace runcert::sbn {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Records that cannot be
/// read are counted and listed. Failure where it holds no epoch, or most of it cannot be read.
///
/// Times are the message's GPS week and time of week; its UTC, which depends on the leap seconds
/// that the receiver has received by then, is compared with them and noted where it is off.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::sbn
