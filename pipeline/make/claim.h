#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "make/given_attempt.h"
#include "make/run_record.h"
#include "run/attempt_files.h"
#include "run/steps.h"
#include "store/opaque_json.h"
#include "store/yaml_input.h"

namespace runcert {

/// An attempt as it is now, with all that it names except recordings.
struct Claim {
    AttemptSource source;
    std::string text;  ///< of the attempt
    Attempt attempt;
    std::vector<YamlValue> profiles;  ///< the claimed ones as written, in that order
    FileHashes files;                 ///< attempt, profiles, and series of wind and current
};

/// Reads an attempt of a day, from its own file if it has one. Failures as of `read_attempt`, and
/// where something cannot be found or the id is no longer the one that the day listed.
Claim read_claim(const GivenAttempt& given);

/// SHA-256 hashes of all files that import reads for a claim, by name in the run folder.
FileHashes recording_hashes(const Claim& claim);

/// What a step uses of the attempt and its profiles beside its input files: for a stage, the fields
/// declared for it, which are all that it gets; null for the steps that read whole files.
OpaqueJson settings_of_step(std::string_view step, const Attempt& attempt,
                            const std::vector<YamlValue>& profiles, const ReportChoice& choice);

}  // namespace runcert
