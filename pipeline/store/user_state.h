#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

/// What a user's programs keep for themselves between two calls, and the names by which they know
/// what they left behind.
namespace runcert {

class Folder;

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

/// ".runcert-WHAT-PROCESS-RANDOM": a name that nobody has given before, for a temporary file or
/// folder. Names that begin so are this program's own: what has one, is the user's and is locked by
/// nobody, is removed by the user's next call there. `what` may be empty.
std::string own_name(std::string_view what = {});

/// Whether an entry has such a name, whatever its ending, and this user is its owner.
bool is_own_name(const Folder& folder, const std::string& name);

}  // namespace runcert
