#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "satellites/ephemeris.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/measured_epoch.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

/// Whether the bytes begin as a RINEX observation file, version 2 or 3.
bool recognises(std::string_view bytes);

/// Whether the receiver's recording is RINEX: as the attempt says, or by its content.
bool is_chosen(const Receiver& receiver, const RecordingBytes& recording);

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

/// What a navigation file holds.
struct NavigationFile {
    std::vector<Ephemeris> ephemerides;  ///< of GPS and Galileo, `place` its first line
    std::vector<std::string> notes;      ///< what was set aside
};

/// Reads broadcast navigation in RINEX 2.00 to 2.12 (GPS) and 3.00 to 3.05 (GPS, Galileo; others
/// are set aside). A record that cannot be read is set aside with a note. Failure with the line
/// where the file is none, or of another version, and where most records cannot be read.
NavigationFile read_navigation(const RecordingBytes& recording);

/// What the header of observations says of receiver ("REC # / TYPE / VERS") and antenna ("ANT # /
/// TYPE"); nothing where it is none.
Instrument instrument_of(std::string_view bytes);

/// What RTKLIB made of a RINEX recording: the evidence of a run, beside the recording itself.
struct Solution {
    std::string configuration;      ///< rnx2rtkp's, of the forward pass
    std::string forward, backward;  ///< .pos files; their header names the program's version
    CalledProgram program;
    Instrument instrument;  ///< as the recording's header says
};

/// Solves the recording by rnx2rtkp of RTKLIB (Debian package rtklib) with the configuration of
/// this program, forwards and backwards in time apart: RTKLIB's own combination counts each epoch's
/// data twice. `base` and `navigation` are RINEX too. The program may take twenty minutes and 4
/// GiB. Failure where it is missing, ends with an error, or finds no position.
Solution solve(const Receiver& receiver, const RecordingBytes& rover, const RecordingBytes& base,
               const std::vector<RecordingBytes>& navigation);

/// The observations of the pass that the attempt chose, which the run folder holds as
/// `chosen_name`, with a note on how far the other one differs at the same epochs.
Observations read(const Receiver& receiver, const Solution& solution,
                  const std::string& chosen_name);

}  // namespace runcert::rinex
