#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace runcert::osnma {

using Bytes = std::vector<std::uint8_t>;

/// Galileo system time: seconds since its week 0, GPS week 1024.
using GalileoSeconds = std::int64_t;
inline constexpr GalileoSeconds galileo_week_s = 604'800;
inline constexpr GalileoSeconds subframe_s = 30;

/// A subframe's time as 12 bits of week and 20 of second ([OSNMA-ICD] table 17).
std::array<std::uint8_t, 4> subframe_time(GalileoSeconds time);

/// How a chain of keys is made, as the root key's message states it ([OSNMA-ICD] 3.2.3).
struct ChainParameters {
    std::size_t blocks = 0;  ///< of the message, of 13 bytes each
    int public_key = 0;      ///< the number of the key that signed it
    bool sha3 = false;       ///< SHA3-256 in place of SHA-256
    bool cmac = false;       ///< CMAC-AES in place of HMAC-SHA-256
    std::size_t key_bytes = 0;
    std::size_t tag_bits = 0;
    GalileoSeconds root_time = 0;  ///< the subframe that the root key would belong to

    /// Tags in a subframe, the first among them.
    std::size_t tags() const { return (480 - 8 * key_bytes) / (tag_bits + 16); }
    std::size_t key_at() const { return tags() * (tag_bits + 16); }
};

/// Reads the first seven bytes of a root key's message. Empty where they use what the interface
/// does not define, or a signature other than ECDSA P-256.
std::optional<ChainParameters> chain_parameters(std::span<const std::uint8_t, 7> begin);

/// A chain of keys: each is the truncated hash of the next one, its own subframe, and a random
/// pattern ([OSNMA-ICD] 6.4).
class KeyChain {
  public:
    using Pattern = std::array<std::uint8_t, 6>;
    KeyChain(const ChainParameters& parameters, const Pattern& alpha)
        : parameters_(parameters), alpha_(alpha) {}

    /// The key that a later one gives for an earlier subframe.
    Bytes key_before(Bytes key, GalileoSeconds time, GalileoSeconds earlier) const;

    /// A tag's bytes by a key, the last one filled up with zeros ([OSNMA-ICD] 6.7).
    Bytes tag(const Bytes& key, std::span<const std::uint8_t> message) const;

  private:
    ChainParameters parameters_;
    Pattern alpha_;
};

/// Tries all values of so few missing bytes, and puts in those that `fits` accepts. False where
/// there are more than three, or none fits.
bool find_missing(std::span<std::uint8_t* const> missing, const std::function<bool()>& fits);

/// SHA-256 of bytes.
std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes);

/// A public key on the curve P-256, by which Galileo signs root keys.
struct PublicKey {
    int number = 0;
    bool is_given = false;                 ///< by the attempt; else one that the program knows
    std::array<std::uint8_t, 33> point{};  ///< compressed (SEC 1, 2.3.3)
};

/// Those that the program knows, as the European GNSS Service Centre published them.
std::vector<PublicKey> known_public_keys();

/// The point of a key in PEM (RFC 7468), whole or compressed. Empty where it is no key on P-256.
std::optional<std::array<std::uint8_t, 33>> point_of_pem(std::string_view pem);

/// Whether a signature (r and s, 32 bytes each) of a message by ECDSA with SHA-256 is the key's.
bool verify_signature(const PublicKey& key, std::span<const std::uint8_t> message,
                      std::span<const std::uint8_t, 64> signature);

}  // namespace runcert::osnma
