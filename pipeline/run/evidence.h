#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"

namespace runcert {

/// The attempt's name in a run folder.
inline constexpr std::string_view evidence_attempt_file = "attempt.yaml";

/// A receiver's recording in a run folder: "recording.ID" and the recording's own extension.
std::string evidence_recording_file(const Receiver& receiver);

/// A claimed profile in a run folder: "profile.NAME.yaml".
std::string evidence_profile_file(const std::string& claimed);

/// What the attempt names, found where it says or, with `evidence`, in a run folder made earlier.
///
/// A missing file is a Failure that names the place in the attempt.
std::string find_recording(const Receiver& receiver, const std::filesystem::path& attempt_file,
                           const std::optional<std::filesystem::path>& evidence);
std::string find_profile(const std::string& claimed, const std::filesystem::path& attempt_file,
                         const std::optional<std::filesystem::path>& evidence);

/// A claimed profile as the run folder holds it. Failure where its id is not its file's name.
Profile read_claimed_profile(const std::filesystem::path& run_dir, const std::string& claimed);

}  // namespace runcert
