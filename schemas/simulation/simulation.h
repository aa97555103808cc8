#pragma once

#include <string>
#include <string_view>

#include "files/document_schema.h"
#include "files/held_json.h"
#include "simulation/raw_measurements.h"
#include "simulation/simulate.h"

namespace runcert {

/// A simulation, `schemas/simulation/v1.yaml`.
struct SimulationDocument {
    SimulationSpec spec;
    std::optional<RawSpec> raw;
    std::string navigation;  ///< of raw measurements, as written
    /// What the attempt to be written says beside its receiver and origin: keys and values of
    /// attempt/1.0, those that a claim cannot do without filled in.
    HeldJson attempt;
    std::string attempt_place;  ///< "file:line:column" of that part, for messages
};

/// Reads and checks a simulation. Failure with file, line, column and remedy on any deviation from
/// the schema, on a run that is none, and on a fault that would not show in the recording.
SimulationDocument read_simulation(std::string_view text, const std::string& where);

const DocumentSchema& simulation_schema();

}  // namespace runcert
