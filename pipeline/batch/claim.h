#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/day_attempts.h"
#include "files/yaml_input.h"
#include "run/attempt_files.h"

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

}  // namespace runcert
