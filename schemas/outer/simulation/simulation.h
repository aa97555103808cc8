#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schemas/simulation/declared.h"
#include "store/document_schema.h"
#include "store/opaque_json.h"

namespace runcert {

/// A simulation, `schemas/simulation/v1.yaml`.
struct SimulationDocument : SimulationSpec {
    /// What the attempt to be written says beside its receiver and origin: keys and values of
    /// attempt/1.0, those that a claim cannot do without filled in.
    OpaqueJson attempt = {};
    std::string attempt_place = {};  ///< "file:line:column" of that part, for messages
};

/// The run's length in whole milliseconds, and the time from one of its epochs to the next.
std::int64_t duration_ms(const LogisticRun& run);
std::int64_t interval_ms(const LogisticRun& run);

/// Failure (at "run") unless 0 < v0 < A / 2 and t0 > 0, all finite.
void require_valid(const LogisticRun& run);

/// Reads and checks a simulation: an outlier that is named by its time has the number of its epoch,
/// and an accuracy that is not stated is that of the errors. Failure with file, line, column and
/// remedy on any deviation from the schema, on a run that is none, and on a fault that would not
/// show in the recording.
SimulationDocument read_simulation(std::string_view text, const std::string& where);

const DocumentSchema& simulation_schema();

}  // namespace runcert
