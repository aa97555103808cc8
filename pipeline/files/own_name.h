#pragma once

#include <string>
#include <string_view>

namespace runcert {

class Folder;

// What this user's programs make for a while in folders that may come from elsewhere: files half
// written, folders in which a run is made. A name alone proves nothing, since anyone can give it,
// and what it names is removed or finished one day. So these names end with a seal by this user's
// secret (record_key.h) over the name and the very folder that it stands in.

/// What tells a folder from every other, and from its copies: its number in its file system and,
/// where that is known, the time at which it was made.
std::string identity_of(const Folder& folder);

/// ".runcert-WHAT-PROCESS-NUMBER-SEAL": a name that this process has not given before. `what`,
/// which may be empty, and an ending (".tmp") that is put behind the name are not secret.
std::string own_name(const Folder& folder, std::string_view what = {});

/// Whether a program of this user gave that name, whatever its ending, in this very folder.
bool is_own_name(const Folder& folder, std::string_view name);

/// A seal over a text by this user's secret, and whether one is. Where no secret is kept, it holds
/// for this process alone.
std::string own_seal(std::string_view text);
bool is_own_seal(std::string_view text, std::string_view seal);

/// Keeps the secret for this user's next programs, where none is kept yet. Where it cannot be kept,
/// they will leave alone what this one may leave behind.
void keep_own_names();

}  // namespace runcert
