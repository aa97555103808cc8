#include <sodium.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/failure.h"
#include "core/text.h"
#include "trust/signature.h"
#include "trust/signature_text.h"
#include "trust/ssh_signature.h"

namespace runcert {
namespace {

using namespace signature_text;

/// A secret key as its file holds it: minisign's own layout, byte for byte.
struct SecretKeyRecord {
    std::array<unsigned char, 2> signature_algorithm{'E', 'd'};
    std::array<unsigned char, 2> key_derivation{};  // "Sc" is scrypt, zeros are none
    std::array<unsigned char, 2> checksum_algorithm{'B', '2'};
    std::array<unsigned char, 32> salt{};
    std::array<unsigned char, 8> operations_limit{};  // little-endian, as is the next
    std::array<unsigned char, 8> memory_limit{};
    struct Secret {
        std::array<unsigned char, 8> key_id{};
        std::array<unsigned char, 64> key{};
        std::array<unsigned char, 32> checksum{};
    } secret;  // encrypted as a whole where there is a password

    SecretKeyRecord() = default;
    SecretKeyRecord(const SecretKeyRecord&) = default;
    SecretKeyRecord& operator=(const SecretKeyRecord&) = delete;
    ~SecretKeyRecord() { sodium_memzero(&secret, sizeof secret); }

    bool is_encrypted() const { return key_derivation[0] == 'S' && key_derivation[1] == 'c'; }
};
static_assert(sizeof(SecretKeyRecord) == 158 && alignof(SecretKeyRecord) == 1);

constexpr std::size_t public_record_size = 42;  // "Ed", id (8), key (32)
constexpr std::size_t longest_password = 1000;

std::array<unsigned char, 8> little_endian(std::uint64_t value) {
    std::array<unsigned char, 8> bytes{};
    for (unsigned char& byte : bytes) {
        byte = static_cast<unsigned char>(value & 0xFFU);
        value >>= 8U;
    }
    return bytes;
}

std::uint64_t from_little_endian(const std::array<unsigned char, 8>& bytes) {
    std::uint64_t value = 0;
    for (auto byte = bytes.rbegin(); byte != bytes.rend(); ++byte)
        value = (value << 8U) | *byte;
    return value;
}

/// BLAKE2b-256 of algorithm, id and key: tells a right password from a wrong one.
std::array<unsigned char, 32> checksum_of(const SecretKeyRecord& record) {
    std::array<unsigned char, 32> checksum{};
    crypto_generichash_state state{};
    crypto_generichash_init(&state, nullptr, 0, checksum.size());
    crypto_generichash_update(&state, record.signature_algorithm.data(),
                              record.signature_algorithm.size());
    crypto_generichash_update(&state, record.secret.key_id.data(), record.secret.key_id.size());
    crypto_generichash_update(&state, record.secret.key.data(), record.secret.key.size());
    crypto_generichash_final(&state, checksum.data(), checksum.size());
    return checksum;
}

/// Encrypts or decrypts the secret part: exclusive or with scrypt's output. False where there is
/// not enough memory for the record's limits.
bool apply_password(SecretKeyRecord& record, std::string_view password) {
    std::array<unsigned char, sizeof(SecretKeyRecord::Secret)> stream{};
    const int status = crypto_pwhash_scryptsalsa208sha256(
        stream.data(), stream.size(), password.data(), password.size(), record.salt.data(),
        from_little_endian(record.operations_limit),
        static_cast<std::size_t>(from_little_endian(record.memory_limit)));
    auto* secret = reinterpret_cast<unsigned char*>(&record.secret);
    for (std::size_t i = 0; status == 0 && i < stream.size(); ++i)
        secret[i] ^= stream[i];
    sodium_memzero(stream.data(), stream.size());
    return status == 0;
}

void encrypt(SecretKeyRecord& record, std::string_view password) {
    if (password.empty() || password.size() > longest_password || !is_printable_line(password))
        throw Failure("password", "this password is empty, too long, or not one line of text",
                      "Choose one of 1 to " + std::to_string(longest_password) + " bytes");
    record.key_derivation = {'S', 'c'};
    record.secret.checksum = checksum_of(record);
    randombytes_buf(record.salt.data(), record.salt.size());
    std::uint64_t operations = crypto_pwhash_scryptsalsa208sha256_OPSLIMIT_SENSITIVE;
    std::uint64_t memory = crypto_pwhash_scryptsalsa208sha256_MEMLIMIT_SENSITIVE;
    for (;;) {
        record.operations_limit = little_endian(operations);
        record.memory_limit = little_endian(memory);
        if (apply_password(record, password)) return;
        operations /= 2;
        memory /= 2;
        if (memory < crypto_pwhash_scryptsalsa208sha256_MEMLIMIT_INTERACTIVE)
            throw Failure("password", "not enough memory to derive a key from it",
                          "Free some memory");
    }
}

void decrypt(SecretKeyRecord& record, std::string_view password, const std::string& where) {
    // A damaged or hostile file must not take all memory, or hours.
    if (from_little_endian(record.memory_limit) >
            crypto_pwhash_scryptsalsa208sha256_MEMLIMIT_SENSITIVE ||
        from_little_endian(record.operations_limit) >
            crypto_pwhash_scryptsalsa208sha256_OPSLIMIT_SENSITIVE)
        throw Failure(where, "its key derivation asks for more than minisign ever does",
                      "Use the file as it was made, whole and unchanged");
    if (!apply_password(record, password))
        throw Failure(where, "not enough memory to derive its key from the password",
                      "Free " + std::to_string(from_little_endian(record.memory_limit) >> 20U) +
                          " MiB of memory");
    const std::array<unsigned char, 32> checksum = checksum_of(record);
    if (sodium_memcmp(checksum.data(), record.secret.checksum.data(), checksum.size()) != 0)
        throw Failure(where, "the password is wrong, or this file is damaged",
                      "Give the password that was chosen when this key was made");
}

/// The line that holds the key: the second, after the comment.
std::string_view key_line(std::string_view text, const std::string& kind,
                          const std::string& where) {
    const std::vector<std::string_view> lines = lines_of(text);
    if (lines.size() != 2 || !lines[0].starts_with(untrusted_prefix))
        throw Failure(where,
                      "this is not a " + kind + " key file: it has " +
                          std::to_string(lines.size()) +
                          " lines where two are expected, the first beginning with \"" +
                          std::string(untrusted_prefix) + "\"",
                      "Name the " + kind + " key file that runcert keygen or minisign -G made");
    return lines[1];
}

SecretKeyRecord parse_record(std::string_view text, const std::string& where) {
    std::string bytes = bytes_of_base64(key_line(text, "secret", where), sizeof(SecretKeyRecord),
                                        "the secret key", where);
    SecretKeyRecord record;
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<unsigned char*>(&record));
    sodium_memzero(bytes.data(), bytes.size());
    const SecretKeyRecord expected;
    const bool derivation_known =
        record.is_encrypted() || record.key_derivation == expected.key_derivation;
    if (record.signature_algorithm != expected.signature_algorithm ||
        record.checksum_algorithm != expected.checksum_algorithm || !derivation_known)
        throw Failure(where, "this is not a minisign secret key, or of an unknown kind",
                      "Name a secret key file that runcert keygen or minisign -G made");
    return record;
}

}  // namespace

SecretKey::~SecretKey() {
    sodium_memzero(bytes_.data(), bytes_.size());
}

KeyPair generate_key_pair() {
    start_libsodium();
    PublicKey public_key;
    SecretKey::Bytes secret{};
    crypto_sign_keypair(public_key.key.data(), secret.data());
    randombytes_buf(public_key.key_id.data(), public_key.key_id.size());
    KeyPair pair{public_key, SecretKey(public_key.key_id, secret)};
    sodium_memzero(secret.data(), secret.size());
    return pair;
}

PublicKey public_key_of(const SecretKey& secret_key) {
    PublicKey public_key;
    public_key.key_id = secret_key.key_id();
    std::copy(secret_key.bytes().begin() + 32, secret_key.bytes().end(), public_key.key.begin());
    return public_key;
}

std::string key_id_text(const PublicKey& public_key) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (auto byte = public_key.key_id.rbegin(); byte != public_key.key_id.rend(); ++byte) {
        text += digits[*byte >> 4U];
        text += digits[*byte & 0x0FU];
    }
    return text;
}

std::string public_key_line(const PublicKey& public_key) {
    std::array<unsigned char, public_record_size> record{'E', 'd'};
    std::copy(public_key.key_id.begin(), public_key.key_id.end(), record.begin() + 2);
    std::copy(public_key.key.begin(), public_key.key.end(), record.begin() + 10);
    return base64_of(record.data(), record.size());
}

std::string public_key_file(const PublicKey& public_key) {
    return std::string(untrusted_prefix) + "runcert public key " + key_id_text(public_key) + "\n" +
           public_key_line(public_key) + "\n";
}

PublicKey parse_public_key(std::string_view text, const std::string& where) {
    const std::vector<std::string_view> lines = lines_of(text);
    const bool key_alone = lines.size() == 1 && !lines[0].starts_with(untrusted_prefix);
    const std::string bytes =
        bytes_of_base64(key_alone ? lines[0] : key_line(text, "public", where), public_record_size,
                        "the public key", where);
    if (!bytes.starts_with("Ed"))
        throw Failure(where, "this is not a minisign public key: it does not begin with \"Ed\"",
                      "Name a public key file that runcert keygen or minisign -G made");
    PublicKey public_key;
    std::copy_n(bytes.begin() + 2, public_key.key_id.size(), public_key.key_id.begin());
    std::copy_n(bytes.begin() + 10, public_key.key.size(), public_key.key.begin());
    return public_key;
}

std::string secret_key_file(const KeyPair& pair, std::optional<std::string_view> password) {
    start_libsodium();
    SecretKeyRecord record;
    record.secret.key_id = pair.secret_key.key_id();
    record.secret.key = pair.secret_key.bytes();
    // Without a password salt, limits and checksum stay zero, as in minisign's own files.
    if (password) encrypt(record, *password);
    return std::string(untrusted_prefix) +
           (password ? "runcert encrypted secret key\n" : "runcert secret key\n") +
           base64_of(reinterpret_cast<const unsigned char*>(&record), sizeof record) + "\n";
}

bool secret_key_is_encrypted(std::string_view text) {
    try {
        return parse_record(text, "").is_encrypted();
    } catch (const Failure&) {
        return false;
    }
}

SecretKey parse_secret_key(std::string_view text, std::optional<std::string_view> password,
                           const std::string& where) {
    start_libsodium();
    SecretKeyRecord record = parse_record(text, where);
    if (record.is_encrypted()) {
        if (!password)
            throw Failure(where, "this secret key is encrypted and no password was given",
                          "Give the password that was chosen when this key was made");
        decrypt(record, *password, where);
    }
    // Signing with a public half that is not the seed's would give the secret away.
    std::array<unsigned char, 32> public_half{};
    SecretKey::Bytes derived{};
    crypto_sign_seed_keypair(public_half.data(), derived.data(), record.secret.key.data());
    const bool consistent =
        sodium_memcmp(derived.data(), record.secret.key.data(), derived.size()) == 0;
    sodium_memzero(derived.data(), derived.size());
    if (!consistent)
        throw Failure(where, "the two halves of this secret key do not belong together",
                      "This file is damaged: use a copy of it, or make a new key");
    return SecretKey(record.secret.key_id, record.secret.key);
}

OtherKey other_key_in(std::string_view text) {
    const std::string make_one =
        "Name a secret key file (NAME.key) that runcert keygen or minisign -G made";
    const std::string_view start = trim(text.substr(0, 4096));
    const std::string_view first_word = start.substr(0, start.find(' '));
    if (start.starts_with("-----BEGIN OPENSSH PRIVATE KEY-----"))
        return {
            "an OpenSSH private key",
            "Sign with it by `ssh-keygen -Y sign -n ROLE@runcert -f KEY report.json` in the run "
            "folder, or name a key that runcert keygen made"};
    if (start.starts_with("-----BEGIN CERTIFICATE")) return {"an X.509 certificate", make_one};
    if (start.starts_with("-----BEGIN PGP")) return {"a PGP key or message", make_one};
    if (start.starts_with("-----BEGIN SSH SIGNATURE"))
        return {"an ssh signature, not a key", make_one};
    if (start.starts_with("-----BEGIN ") && start.find("PRIVATE KEY") != std::string_view::npos)
        return {"a private key in PEM form", make_one};
    if (start.starts_with("-----BEGIN ") && start.find("PUBLIC KEY") != std::string_view::npos)
        return {"a public key in PEM form", make_one};
    if (is_ssh_key_type(first_word))
        return {"a public key of OpenSSH", make_one + "; a public key cannot sign"};
    const auto lines = signature_text::lines_of(text);
    const bool signature =
        lines.size() == 4 && lines[2].starts_with(signature_text::trusted_prefix);
    if (signature) return {"a signature, not a key", make_one};
    // "RW" is how base64 of minisign's "Ed" begins; secret and public keys differ in their length.
    constexpr std::size_t public_line_length = 56;
    if (!lines.empty() && lines.size() <= 2 && lines.back().starts_with("RW") &&
        lines.back().size() == public_line_length)
        return {"a public key", make_one + "; a public key cannot sign"};
    return {};
}

bool holds_secret_key(std::string_view bytes) {
    using namespace std::string_view_literals;
    // The last two begin base64 of minisign's, with a password and without one.
    for (const auto mark : {"PRIVATE KEY-----"sv, "PRIVATE KEY BLOCK-----"sv, "AGE-SECRET-KEY-1"sv,
                            "PuTTY-User-Key-File-"sv, "RWRTY0Iy"sv, "RWQAAEIy"sv})
        if (bytes.find(mark) != std::string_view::npos) return true;
    // The secret of records: 32 bytes in hexadecimal.
    return bytes.find_first_not_of("0123456789abcdef") == 64 && bytes.substr(64) == "\n";
}

}  // namespace runcert
