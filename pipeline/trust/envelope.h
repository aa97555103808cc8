#pragma once

#include <array>
#include <string>
#include <string_view>

#include "trust/signature.h"

/// Signed statements as in-toto's envelopes, DSSE:
/// https://github.com/secure-systems-lab/dsse/blob/master/protocol.md
namespace runcert {

/// The type of every payload here: an in-toto statement.
inline constexpr std::string_view statement_payload_type = "application/vnd.in-toto+json";

/// The bytes that an envelope's signature is of (PAE): "DSSEv1 LEN(type) type LEN(payload)
/// payload", lengths in bytes.
std::string dsse_bytes(std::string_view payload_type, std::string_view payload);

/// An envelope taken apart. Nothing of it is checked; of who signed it says nothing that counts.
struct Envelope {
    std::string payload{};
    std::array<unsigned char, 64> signature{};  ///< Ed25519
    std::string key_id{};                       ///< which nobody vouches for
};

/// The text of the envelope of a statement, signed: one line of JSON.
std::string sign_envelope(std::string_view payload, const SecretKey& key);

/// Reads an envelope. Failure where it is anything but what sign_envelope writes for its payload,
/// signature and key id, byte for byte: no change of it goes unseen.
Envelope read_envelope(std::string_view text, const std::string& where);

/// Whether the key signed the payload, as a statement.
bool envelope_holds(const Envelope& envelope, const PublicKey& key);

}  // namespace runcert
