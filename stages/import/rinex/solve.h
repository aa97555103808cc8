#pragma once

#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

/// What RTKLIB made of a RINEX recording: the evidence of a run, beside the recording itself.
struct Solution {
    std::string configuration;      ///< rnx2rtkp's, of the forward pass
    std::string forward, backward;  ///< .pos files; their header names the program's version
    CalledProgram program;
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
