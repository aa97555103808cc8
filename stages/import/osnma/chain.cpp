#include "stages/import/osnma/chain.h"

#include <nettle/bignum.h>
#include <nettle/cmac.h>
#include <nettle/ecc-curve.h>
#include <nettle/ecdsa.h>
#include <nettle/hmac.h>
#include <nettle/sha2.h>
#include <nettle/sha3.h>

#include <algorithm>
#include <string>

#include "core/text.h"
#include "store/base64.h"

namespace runcert::osnma {
namespace {

constexpr PublicKey first_key{
    .number = 1, .point = {0x03, 0x97, 0xeb, 0x43, 0x78, 0x9a, 0xa0, 0xf6, 0xd0, 0x52, 0xa6,
                           0x38, 0x46, 0x8e, 0xcf, 0x52, 0x78, 0xe6, 0xf6, 0xdf, 0x84, 0x65,
                           0xec, 0xb8, 0xd8, 0xb8, 0x4b, 0x8c, 0x7a, 0x35, 0x01, 0xf7, 0x3b}};

/// Numbers of the multiple-precision library that are freed.
class Number {
  public:
    Number() { mpz_init(value_); }
    explicit Number(std::span<const std::uint8_t> bytes) {
        nettle_mpz_init_set_str_256_u(value_, bytes.size(), bytes.data());
    }
    explicit Number(const char* hexadecimal) { mpz_init_set_str(value_, hexadecimal, 16); }
    Number(const Number&) = delete;
    Number& operator=(const Number&) = delete;
    ~Number() { mpz_clear(value_); }
    mpz_t& get() { return value_; }

  private:
    mpz_t value_;
};

/// The second coordinate of a compressed point: the root of x^3 - 3 x + b (SEC 1, 2.3.4), of the
/// parity that the first byte states. On P-256 a root is a power, as p is 3 modulo 4.
void set_second_coordinate(mpz_t y, const mpz_t x, unsigned parity) {
    Number p("ffffffff00000001000000000000000000000000ffffffffffffffffffffffff");
    Number square("5ac635d8aa3a93e7b3ebbd55769886bc651d06b0cc53b0f63bce3c3e27d2604b");
    Number power;
    mpz_powm_ui(power.get(), x, 3, p.get());
    mpz_submul_ui(power.get(), x, 3);
    mpz_add(square.get(), square.get(), power.get());
    mpz_add_ui(power.get(), p.get(), 1);
    mpz_fdiv_q_2exp(power.get(), power.get(), 2);
    mpz_powm(y, square.get(), power.get(), p.get());
    if (mpz_odd_p(y) != static_cast<int>(parity)) mpz_sub(y, p.get(), y);
}

}  // namespace

std::array<std::uint8_t, 4> subframe_time(GalileoSeconds time) {
    const auto bits =
        static_cast<std::uint32_t>((time / galileo_week_s % 4096) << 20 | time % galileo_week_s);
    return {static_cast<std::uint8_t>(bits >> 24), static_cast<std::uint8_t>(bits >> 16 & 0xffU),
            static_cast<std::uint8_t>(bits >> 8 & 0xffU), static_cast<std::uint8_t>(bits & 0xffU)};
}

std::optional<ChainParameters> chain_parameters(std::span<const std::uint8_t, 7> begin) {
    constexpr std::array<std::size_t, 9> key_bits{96, 104, 112, 120, 128, 160, 192, 224, 256};
    constexpr std::array<std::size_t, 10> tag_bits{0, 0, 0, 0, 0, 20, 24, 28, 32, 40};
    const unsigned blocks = begin[0] >> 4U, hash = begin[1] >> 2U & 3U, mac = begin[1] & 3U;
    const unsigned key_size = begin[2] >> 4U, tag_size = begin[2] & 15U;
    const GalileoSeconds week = (begin[4] & 15U) << 8U | begin[5];
    if (blocks < 1 || blocks > 8 || (hash != 0 && hash != 2) || mac > 1 ||
        key_size >= key_bits.size() || tag_size < 5 || tag_size >= tag_bits.size())
        return std::nullopt;
    const ChainParameters found{
        .blocks = blocks + 6,
        .public_key = begin[0] & 15,
        .sha3 = hash == 2,
        .cmac = mac == 1,
        .key_bytes = key_bits[key_size] / 8,
        .tag_bits = tag_bits[tag_size],
        .root_time = week * galileo_week_s + begin[6] * GalileoSeconds{3600} - subframe_s};
    // Beside header, key and a signature of 64 bytes, less than a block is padding.
    const std::size_t used = 13 + found.key_bytes + 64;
    if (13 * found.blocks < used || 13 * found.blocks >= used + 13) return std::nullopt;
    return found;
}

Bytes KeyChain::key_before(Bytes key, GalileoSeconds time, GalileoSeconds earlier) const {
    std::array<std::uint8_t, 32> hash{};
    while (time > earlier) {
        time -= subframe_s;
        const auto of = subframe_time(time);
        if (parameters_.sha3) {
            sha3_256_ctx state;
            sha3_256_init(&state);
            sha3_256_update(&state, key.size(), key.data());
            sha3_256_update(&state, of.size(), of.data());
            sha3_256_update(&state, alpha_.size(), alpha_.data());
            sha3_256_digest(&state, hash.size(), hash.data());
        } else {
            sha256_ctx state;
            sha256_init(&state);
            sha256_update(&state, key.size(), key.data());
            sha256_update(&state, of.size(), of.data());
            sha256_update(&state, alpha_.size(), alpha_.data());
            sha256_digest(&state, hash.size(), hash.data());
        }
        std::ranges::copy_n(hash.begin(), static_cast<std::ptrdiff_t>(key.size()), key.begin());
    }
    return key;
}

Bytes KeyChain::tag(const Bytes& key, std::span<const std::uint8_t> message) const {
    std::array<std::uint8_t, 32> mac{};
    if (parameters_.cmac) {
        cmac_aes128_ctx state;
        std::array<std::uint8_t, 16> key_16{};
        std::ranges::copy_n(key.begin(),
                            static_cast<std::ptrdiff_t>(std::min<std::size_t>(16, key.size())),
                            key_16.begin());
        cmac_aes128_set_key(&state, key_16.data());
        cmac_aes128_update(&state, message.size(), message.data());
        cmac_aes128_digest(&state, 16, mac.data());
    } else {
        hmac_sha256_ctx state;
        hmac_sha256_set_key(&state, key.size(), key.data());
        hmac_sha256_update(&state, message.size(), message.data());
        hmac_sha256_digest(&state, mac.size(), mac.data());
    }
    Bytes tag(mac.begin(),
              mac.begin() + static_cast<std::ptrdiff_t>((parameters_.tag_bits + 7) / 8));
    if (parameters_.tag_bits % 8 != 0)
        tag.back() &= static_cast<std::uint8_t>(0xff << (8 - parameters_.tag_bits % 8));
    return tag;
}

bool find_missing(std::span<std::uint8_t* const> missing, const std::function<bool()>& fits) {
    if (missing.size() > 3) return false;
    for (std::uint32_t value = 0; value < 1U << (8 * missing.size()); ++value) {
        for (std::size_t i = 0; i < missing.size(); ++i)
            *missing[i] = static_cast<std::uint8_t>(value >> (8 * i) & 0xffU);
        if (fits()) return true;
    }
    return false;
}

std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes) {
    std::array<std::uint8_t, 32> hash{};
    sha256_ctx state;
    sha256_init(&state);
    sha256_update(&state, bytes.size(), bytes.data());
    sha256_digest(&state, hash.size(), hash.data());
    return hash;
}

std::vector<PublicKey> known_public_keys() {
    return {first_key};
}

std::optional<std::array<std::uint8_t, 33>> point_of_pem(std::string_view pem) {
    std::string text;
    while (!pem.empty()) {
        const std::string_view line = trim(pem.substr(0, pem.find('\n')));
        if (!line.starts_with("-----")) text += line;
        pem.remove_prefix(std::min(pem.size(), pem.find('\n')));
        pem.remove_prefix(std::min<std::size_t>(pem.size(), 1));
    }
    const std::optional<std::string> bytes = decode_base64(text);
    // Everything but the point is the same in all keys on this curve (RFC 5480).
    constexpr std::string_view whole(
        "\x30\x59\x30\x13\x06\x07\x2a\x86\x48\xce\x3d\x02\x01\x06\x08"
        "\x2a\x86\x48\xce\x3d\x03\x01\x07\x03\x42\x00\x04",
        27);
    constexpr std::string_view compressed(
        "\x30\x39\x30\x13\x06\x07\x2a\x86\x48\xce\x3d\x02\x01\x06\x08"
        "\x2a\x86\x48\xce\x3d\x03\x01\x07\x03\x22\x00",
        26);
    std::array<std::uint8_t, 33> point{};
    if (!bytes) return std::nullopt;
    if (bytes->starts_with(whole) && bytes->size() == whole.size() + 64) {
        point[0] = static_cast<std::uint8_t>(2 + (bytes->back() & 1));
        std::copy_n(bytes->begin() + whole.size(), 32, point.begin() + 1);
        return point;
    }
    if (!bytes->starts_with(compressed) || bytes->size() != compressed.size() + point.size() ||
        ((*bytes)[compressed.size()] != 2 && (*bytes)[compressed.size()] != 3))
        return std::nullopt;
    std::copy_n(bytes->begin() + compressed.size(), point.size(), point.begin());
    return point;
}

bool verify_signature(const PublicKey& key, std::span<const std::uint8_t> message,
                      std::span<const std::uint8_t, 64> signature) {
    Number x(std::span(key.point).subspan<1>()), y, r(signature.first<32>()),
        s(signature.last<32>());
    set_second_coordinate(y.get(), x.get(), key.point[0] & 1U);
    ecc_point point;
    ecc_point_init(&point, nettle_get_secp_256r1());
    dsa_signature given;
    dsa_signature_init(&given);
    mpz_set(given.r, r.get());
    mpz_set(given.s, s.get());
    const auto hash = sha256(message);
    const bool valid = ecc_point_set(&point, x.get(), y.get()) == 1 &&
                       ecdsa_verify(&point, hash.size(), hash.data(), &given) == 1;
    dsa_signature_clear(&given);
    ecc_point_clear(&point);
    return valid;
}

}  // namespace runcert::osnma
