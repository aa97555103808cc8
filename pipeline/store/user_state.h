#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

/// What a user's programs keep for themselves between two calls, and the names by which they know
/// what they left behind.
namespace runcert {

/// The folder of this user's state: $XDG_STATE_HOME/runcert, else ~/.local/state/runcert. Nothing
/// where the user has no home.
std::optional<std::filesystem::path> state_folder();

/// Why nothing can be kept there, a sentence; empty where it can. Others than the user could write
/// there, or it cannot be made.
std::string missing_state();

/// What `remember` kept of that ("report 0123..."); empty where there is nothing, or where others
/// could have written it. It is a cache: no answer depends on its being there.
std::string recalled(std::string_view of);

/// Keeps a text for the next calls, in place of an earlier one; an empty one is forgotten. Where it
/// cannot be kept, nothing happens.
void remember(std::string_view of, std::string_view text);

/// What is remembered about a folder, wherever it is reached from: "WHAT FOLDER", for both.
std::string about_folder(std::string_view what, const std::filesystem::path& folder);

/// ".runcert-PROCESS-RANDOM-PROOF": a name that nobody has given before, for a temporary file or
/// folder that the user's next call removes where this one is killed. A name alone proves nothing,
/// since anyone can give it: the end depends on a secret in the state folder. Where none can be
/// kept, it holds for this process alone.
std::string own_name();

/// Whether a program of this user gave that name, whatever its ending (".tmp").
bool is_own_name(std::string_view name);

/// The SHA-256 of a program's file, remembered as long as the system says that it was not written
/// since: its time of change nobody can set. Failure where it cannot be read.
std::string remembered_sha256(const std::filesystem::path& file);

}  // namespace runcert
