#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "store/utc_second.h"

/// Signatures by `ssh-keygen -Y sign`:
/// https://github.com/openssh/openssh-portable/blob/master/PROTOCOL.sshsig

namespace runcert {

/// A public key as OpenSSH holds it: RFC 4253 section 6.6, RFC 8709.
struct SshPublicKey {
    std::string type{};  ///< "ssh-ed25519", "ecdsa-sha2-nistp256", ...
    std::string blob{};  ///< the key's wire format, which begins with the type

    bool operator==(const SshPublicKey&) const = default;
};

/// The 32 bytes of an Ed25519 key, which are the same in minisign's files.
using Ed25519Key = std::array<unsigned char, 32>;

/// Whether a word is a type of key that signatures can be made with here.
bool is_ssh_key_type(std::string_view word);

/// The types, for messages: "ssh-ed25519, ecdsa-sha2-nistp256, ...".
std::string ssh_key_types();

/// The key of a type and its base64, as a line "TYPE BASE64 COMMENT" holds them. Failure where the
/// base64 is none, or does not hold a key of that type.
SshPublicKey parse_ssh_public_key(std::string_view type, std::string_view base64,
                                  const std::string& where);

/// An Ed25519 key as OpenSSH holds it, and back; nothing for keys of another type.
SshPublicKey ssh_key_of(const Ed25519Key& key);
std::optional<Ed25519Key> ed25519_of(const SshPublicKey& key);

/// "TYPE BASE64", as in an authorized_keys or allowed_signers line.
std::string ssh_key_text(const SshPublicKey& key);

/// What a key is that is weaker than Ed25519, ECDSA P-256 and RSA of 3072 bits, which are about as
/// strong [NIST SP 800-57 part 1, table 2]: "RSA of 2048 bits"; else empty.
std::string weakness_of(const SshPublicKey& key);

/// The least bits of an RSA modulus that anything is signed with here.
inline constexpr unsigned least_rsa_bits = 3072;

/// "SHA256:...", as `ssh-keygen -l` prints it.
std::string ssh_fingerprint(const SshPublicKey& key);

/// What a signature file claims. Nothing of it is checked.
struct SshSignature {
    SshPublicKey key{};
    std::string name_space{};  ///< what it was made for, "measurer@runcert"
    std::string hash_algorithm{};
};

/// Reads the armoured text that `ssh-keygen -Y sign` writes. `where` names it in messages. Failure
/// where it is anything else.
SshSignature parse_ssh_signature(std::string_view text, const std::string& where);

struct SshCheck {
    bool valid = false;
    std::string said{};  ///< by ssh-keygen, where it is not
};

/// Asks `ssh-keygen -Y verify` whether `signature_file` is a signature of the bytes of
/// `signed_file` by a key that the lines of `allowed_signers` allow for `principal` and
/// `name_space` at that time. Failure where there is no ssh-keygen.
SshCheck check_ssh_signature(const std::filesystem::path& signed_file,
                             const std::filesystem::path& signature_file,
                             std::string_view allowed_signers, const std::string& principal,
                             const std::string& name_space, UtcSecond time);

}  // namespace runcert
