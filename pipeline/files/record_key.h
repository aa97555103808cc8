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

/// The secret in the file `records.key` of a folder, made at first use with mode 0600. Several that
/// begin at once get the same. Where there is no folder, or none can be made, the secret is a
/// passing one. Failure where the file is not what was written, or others than its owner can use
/// it.
KeptRecordKey record_key_in(const std::optional<std::filesystem::path>& folder);

/// The secret in this user's folder of state, where there is one that can be used.
std::optional<RecordKey> kept_record_key();

}  // namespace runcert
