#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "store/utc_second.h"

/// Ed25519 signatures in minisign's file formats, prehashed with BLAKE2b-512 ("ED"):
/// https://jedisct1.github.io/minisign/#signature-format. `minisign -Vm FILE -p KEY.pub` accepts
/// what is made here, and what `minisign -S` makes is accepted here.

namespace runcert {

/// An Ed25519 public key and the 8 random bytes that name its pair. The id is a label for people:
/// only the key decides whether a signature is valid.
struct PublicKey {
    using Id = std::array<unsigned char, 8>;

    Id key_id{};
    std::array<unsigned char, 32> key{};

    bool operator==(const PublicKey&) const = default;
};

/// An Ed25519 secret key with the id of its pair. Its memory is wiped when it is destroyed.
class SecretKey {
  public:
    using KeyId = std::array<unsigned char, 8>;
    using Bytes = std::array<unsigned char, 64>;  ///< seed (32) and public key (32)

    SecretKey(const KeyId& key_id, const Bytes& bytes) : key_id_(key_id), bytes_(bytes) {}
    SecretKey(const SecretKey&) = default;
    SecretKey& operator=(const SecretKey&) = default;
    ~SecretKey();

    const KeyId& key_id() const { return key_id_; }
    const Bytes& bytes() const { return bytes_; }

  private:
    KeyId key_id_;
    Bytes bytes_;
};

struct KeyPair {
    PublicKey public_key;
    SecretKey secret_key;
};

/// A new key pair with a new id, from the system's random source.
KeyPair generate_key_pair();

/// The public half of a secret key.
PublicKey public_key_of(const SecretKey& secret_key);

/// The key's id as minisign prints it: 16 upper-case hexadecimal digits, most significant byte
/// first (the file holds the least significant first).
std::string key_id_text(const PublicKey& public_key);

/// The text of a public key file (`NAME.pub`): a comment line and a line of base64.
std::string public_key_file(const PublicKey& public_key);

/// Reads a public key file, or its base64 line alone (as `minisign -P` takes it). `where` names
/// the text in messages. Failure where it is anything else.
PublicKey parse_public_key(std::string_view text, const std::string& where);

/// The text of a secret key file (`NAME.key`), which `minisign -S -s NAME.key` reads too. With a
/// password it is encrypted with a key derived by scrypt, which takes a few seconds and 1 GiB of
/// memory (less where there is less, as in minisign). Failure where the password is empty, longer
/// than minisign reads (1000 bytes), or not one line.
std::string secret_key_file(const KeyPair& pair, std::optional<std::string_view> password);

/// Whether the text is a secret key file that needs a password. False where it is not a secret
/// key file at all: parse_secret_key says what is wrong with it.
bool secret_key_is_encrypted(std::string_view text);

/// Reads a secret key file, ours or minisign's. `where` names it in messages.
/// A password that is not needed is ignored. Failure where the text is malformed, and where a
/// password is needed and missing or wrong.
SecretKey parse_secret_key(std::string_view text, std::optional<std::string_view> password,
                           const std::string& where);

/// Signs `message` and gives the text of its signature file (`FILE.minisig`). The trusted comment
/// is signed too; the untrusted one is always the same, since nobody answers for it. Failure where
/// the comment is not one line of printable text (UTF-8, no control characters) or is longer than
/// minisign reads (8000 bytes).
std::string sign(std::string_view message, const SecretKey& secret_key,
                 std::string_view trusted_comment);

/// What checking a signature found.
struct SignatureCheck {
    bool valid = false;
    std::string trusted_comment;  ///< empty unless valid
    std::string key_id;  ///< the id in the signature file, as key_id_text prints it; a claim
    std::string reason;  ///< why it is not valid, in words; empty where it is
    /// The trusted comment if the key signed it, even if its signature over the message does not
    /// hold: it then tells which message the signature was made for.
    std::string vouched_comment;
};

/// Checks a signature file over `message` with a public key. `where` names the signature file in
/// messages. Another key's signature, a changed message, a changed trusted comment and the legacy
/// format without prehashing ("Ed") are findings, with a reason. Failure where the text is not a
/// signature file.
SignatureCheck check_signature(std::string_view message, std::string_view signature_file_text,
                               const PublicKey& public_key, const std::string& where);

/// What a signature file claims. Nothing of it is checked.
struct SignatureClaims {
    PublicKey::Id key_id{};
    std::string trusted_comment{};
};

/// Reads a signature file without checking it. Failure where the text is not a signature file.
SignatureClaims read_signature_claims(std::string_view signature_file_text,
                                      const std::string& where);

/// The public key as one line of base64, as `minisign -P` takes it.
std::string public_key_line(const PublicKey& public_key);

/// What a key file holds that is no secret key of ours: "a public key", "an OpenSSH private key"
/// and so on, with what to do. Empty where it is nothing that is known.
struct OtherKey {
    std::string kind{};
    std::string remedy{};
};
OtherKey other_key_in(std::string_view text);

/// Whether a file holds a secret key of minisign, runcert, OpenSSH, PGP, age, PuTTY or in PEM form.
bool holds_secret_key(std::string_view bytes);

/// What a signer of a report states along with the signature, and signs too:
/// "runcert report=REPORT_ID attempt=ID role=ROLE key=RW... signed=2026-11-21T20:41:50Z".
struct TrustedComment {
    std::string report_id{};
    std::string attempt_id{};
    std::string role{};
    std::string key{};  ///< the signer's public key as `minisign -P` takes it
    std::string signed_at{};
    std::string recomputed{};  ///< "no" where the signer left the recomputation out; else empty
    std::string repeated{};    ///< a field that is there twice, which programs read differently
};

std::string trusted_comment_text(const TrustedComment& comment);

/// What a trusted comment states. Fields that are not there stay empty, as do all of a comment that
/// is not of this form.
TrustedComment parse_trusted_comment(std::string_view text);

}  // namespace runcert
