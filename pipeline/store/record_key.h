#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// A user's secret, by which programs know what the same user's programs wrote.
class RecordKey {
  public:
    static constexpr std::size_t size = 32;  ///< bytes
    using Bytes = std::array<unsigned char, size>;

    /// A random one, which no other program knows.
    RecordKey();
    explicit RecordKey(const Bytes& bytes) : bytes_(bytes) {}

    /// The keyed BLAKE2b hash of a text: 64 hexadecimal digits.
    std::string seal(std::string_view text) const;

    /// Whether this key sealed the text so. Takes as long whatever differs.
    bool sealed(std::string_view text, std::string_view seal) const;

  private:
    Bytes bytes_{};
};

/// A secret, and why it holds for this call alone.
struct KeptRecordKey {
    RecordKey key{};
    /// A sentence; empty where the user's next batch has the same secret.
    std::string passing{};
};

/// The folder of this user's state: $XDG_STATE_HOME/runcert, else ~/.local/state/runcert. Nothing
/// where the user has no home.
std::optional<std::filesystem::path> state_folder();

/// The secret in the file `records.key` of a folder, made at first use with mode 0600. Programs
/// that start at once get the same. Where there is no folder, or none can be made, the secret holds
/// for this call alone. Failure where the file is not what was written, or others than its owner
/// can use it.
KeptRecordKey record_key_in(const std::optional<std::filesystem::path>& folder);

/// The secret in this user's folder of state, where there is one that can be used.
std::optional<RecordKey> kept_record_key();

class Folder;

// Names of temporary files and folders that this user's programs make in folders which may come
// from elsewhere. A name alone proves nothing, since anyone can give it, and what it names is
// removed or finished one day. So these names end with a seal by this user's secret over the name
// and the very folder that it stands in.

/// What tells a folder from every other, and from its copies: its inode number and, where that is
/// known, the time at which it was made.
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

/// Keeps the secret for this user's next programs, where none is kept yet. Where that fails, they
/// will not touch what this one may leave behind.
void keep_own_names();

}  // namespace runcert
