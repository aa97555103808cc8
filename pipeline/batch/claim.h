#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "batch/day_attempts.h"
#include "files/held_json.h"
#include "files/yaml_input.h"
#include "run/attempt_files.h"
#include "run/steps.h"

namespace runcert {

/// Names of files in a run folder, with the SHA-256 of each.
using FileHashes = std::map<std::string, std::string>;

/// An attempt as it is now, with all that it names beside recordings.
struct Claim {
    AttemptSource source;
    std::string text;  ///< of the attempt
    Attempt attempt;
    std::vector<YamlValue> profiles;  ///< the claimed ones as written, in that order
    FileHashes files;                 ///< attempt, profiles, and series of wind and current
};

/// Reads an attempt of a day, which is read again where it has a file of its own. `composed` is
/// where the text of one without is kept, for messages to name. Failures as of `read_attempt` and
/// of what cannot be found, and where the id is no longer the one by which the day knows it.
Claim read_claim(const DayAttempt& given, const std::filesystem::path& composed);

/// The hashes of a claim's recordings, and of what else import reads, by name in the run folder.
FileHashes recording_hashes(const Claim& claim);

/// About how many epochs a claim's recordings hold together, without reading them.
std::uint64_t estimated_epochs(const Claim& claim);

/// What of the attempt and its profiles a step uses beside its input files: of a stage that which
/// the fields declare for it, and it gets no more; null for the steps that read whole files.
HeldJson settings_of_step(std::string_view step, const Attempt& attempt,
                          const std::vector<YamlValue>& profiles, const ReportChoice& choice);

}  // namespace runcert
