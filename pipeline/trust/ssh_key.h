#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

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

/// The key that a wire format holds. Failures as above.
SshPublicKey ssh_key_of_blob(std::string blob, const std::string& where);

/// An Ed25519 key as OpenSSH holds it, and back; nothing for keys of another type.
SshPublicKey ssh_key_of(const Ed25519Key& key);
std::optional<Ed25519Key> ed25519_of(const SshPublicKey& key);

/// "TYPE BASE64", as in an authorized_keys or allowed_signers line.
std::string ssh_key_text(const SshPublicKey& key);

/// What a key is that is weaker than Ed25519, ECDSA P-256 and RSA of 3072 bits, which are about as
/// strong [NIST SP 800-57 part 1, table 2]: "RSA of 2048 bits"; else empty.
std::string weakness_of(const SshPublicKey& key);

/// The least bits of an RSA modulus and of an elliptic curve that anything is signed with here.
inline constexpr unsigned least_rsa_bits = 3072;
inline constexpr unsigned least_curve_bits = 256;

/// "SHA256:...", as `ssh-keygen -l` prints it.
std::string ssh_fingerprint(const SshPublicKey& key);

/// Bytes at the front of a wire format: a string of RFC 4251 section 5, taken off `rest`. Nothing
/// where there are fewer bytes than its length says.
std::optional<std::string_view> take_wire_string(std::string_view& rest);

/// The bytes that base64 (RFC 4648 section 4, padded) holds; nothing where it is not base64.
std::optional<std::string> decode_base64(std::string_view text);

}  // namespace runcert
